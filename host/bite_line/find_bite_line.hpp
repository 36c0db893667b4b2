// SPDX-License-Identifier: MIT
#pragma once
/// \file From a shoe's points to its bite line, or to the reason why there is none.

#include <optional>

#include "host/bite_line/extraction.hpp"
#include "host/bite_line/scan_points.hpp"
#include "host/bite_line/workings.hpp"
#include "host/cloud/point_cloud.hpp"

namespace biteline::bite_line {

/// The steps of the method, one after the other.  Nothing is thrown: a cloud in which nothing can be found is
/// refused, with the reason.  Works on all cores (oneTBB).  `workings` (optional): what the steps handed on;
/// nothing when the cloud holds no shoe.
[[nodiscard]] Extraction find_bite_line(const ScanPoints& scan, const Config& config,
                                        std::optional<Workings>* workings = nullptr);

/// Of a cloud in any order.  One in scan order gives the same line as the running scan.
[[nodiscard]] Extraction find_bite_line(const cloud::PointCloud& cloud, const Config& config,
                                        std::optional<Workings>* workings = nullptr);

}  // namespace biteline::bite_line
