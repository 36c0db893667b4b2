// SPDX-License-Identifier: MIT
#pragma once
/// \file A path of the side placed in the raw points of its scan.

#include <span>

#include "host/bite_line/place/placement.hpp"
#include "host/bite_line/scan_points.hpp"
#include "host/bite_line/side/side.hpp"

namespace biteline::bite_line {

/// What is known of the layers along a path, per column (PlacedStation).
struct AlongPath {
  std::span<const float> hold, other_mm, sharp;
  std::span<const float> upright_ratio{};
};

/// place_line() of the path (a row per column of the side's grid) with the points of `scan` around it.
[[nodiscard]] PlacedLine place_path(const ScanPoints& scan, const Side& side,
                                    std::span<const double> path_row, const AlongPath& along,
                                    double spacing_mm);

}  // namespace biteline::bite_line
