// SPDX-License-Identifier: MIT
#pragma once
/// \file A path as a curve in space, whole even where its surface was not seen.

#include <cstddef>
#include <span>
#include <vector>

#include "host/bite_line/shoe/plan.hpp"
#include "host/bite_line/side/side_field.hpp"

namespace biteline::bite_line {

/// The curve of a path in plan, and the height along it.
struct PathCurve {
  std::vector<Vec2> plan;
  std::vector<double> z_mm;
};

/// The path in 3-D; where its surface was not seen it goes on as a cubic that leaves both ends in their own
/// directions, since a chord would cut off the curve of a toe.
[[nodiscard]] PathCurve curve_of(const SideField& field, const Outline& outline,
                                 std::span<const double> path_row);

/// Height of a path given at scattered s, at evenly spaced stations of its own outline.
[[nodiscard]] std::vector<double> heights_at_stations(const PathCurve& curve, const Outline& path_outline,
                                                      std::size_t stations);

}  // namespace biteline::bite_line
