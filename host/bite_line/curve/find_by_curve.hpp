// SPDX-License-Identifier: MIT
#pragma once
/// \file The bite line as the cheapest closed curve of one energy: beside find_bite_line(), to be compared
/// with it.

#include <optional>
#include <vector>

#include "host/bite_line/curve/curve_posterior.hpp"
#include "host/bite_line/curve/curve_search.hpp"
#include "host/bite_line/extraction.hpp"
#include "host/bite_line/scan_points.hpp"
#include "host/bite_line/side/side.hpp"
#include "host/bite_line/workings.hpp"
#include "host/cloud/point_cloud.hpp"

namespace biteline::bite_line {

/// The best curve on a side, and what is known of it.
struct CurveOnSide {
  ClosedCurve curve;
  double evidence{0};                  ///< mean probability of its places by the surface alone, 0 to 1
  std::vector<CurveStation> stations;  ///< a place of the curve after the other, once round
};
/// None where the side has none.
[[nodiscard]] std::optional<CurveOnSide> curve_on(const Side& side);

/// As find_bite_line(): shoe, side, evidence, curve, posterior, gates, place.
[[nodiscard]] Extraction find_by_curve(const ScanPoints& scan, const Config& config,
                                       std::optional<Workings>* workings = nullptr);
[[nodiscard]] Extraction find_by_curve(const cloud::PointCloud& cloud, const Config& config,
                                       std::optional<Workings>* workings = nullptr);

}  // namespace biteline::bite_line
