// SPDX-License-Identifier: MIT
#pragma once
/// \file A path as a curve in space, whole even where its surface was not seen.

#include <span>
#include <vector>

#include "host/bite_line/shoe/plan.hpp"
#include "host/bite_line/side/side_field.hpp"

namespace biteline::bite_line {

/// A path's own outline, and its height at stations evenly spaced along that.
struct PathCurve {
  Outline outline;
  std::vector<double> z_mm;
};

/// Of a path (a row of the field per column of it).  Where its surface was not seen it goes on as a cubic
/// that leaves both ends in their own directions, since a chord would cut off the curve of a toe.
[[nodiscard]] PathCurve curve_of(const SideField& field, const Outline& outline,
                                 std::span<const double> path_row, double spacing_mm);

}  // namespace biteline::bite_line
