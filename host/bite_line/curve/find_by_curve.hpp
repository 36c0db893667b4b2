// SPDX-License-Identifier: MIT
#pragma once
/// \file The bite line as the cheapest closed curve of one energy: beside find_bite_line(), to be compared
/// with it.

#include <optional>

#include "host/bite_line/extraction.hpp"
#include "host/bite_line/scan_points.hpp"
#include "host/bite_line/workings.hpp"
#include "host/cloud/point_cloud.hpp"

namespace biteline::bite_line {

/// As find_bite_line(): shoe, side, evidence, curve, posterior, gates, place.
[[nodiscard]] Extraction find_by_curve(const ScanPoints& scan, const Config& config,
                                       std::optional<Workings>* workings = nullptr);
[[nodiscard]] Extraction find_by_curve(const cloud::PointCloud& cloud, const Config& config,
                                       std::optional<Workings>* workings = nullptr);

}  // namespace biteline::bite_line
