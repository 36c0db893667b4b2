// SPDX-License-Identifier: MIT
#pragma once
/// \file A closed cubic curve through the points of a line.

#include <vector>

#include "common/geometry/se3.hpp"
#include "host/cloud/closed_line.hpp"

namespace biteline::line_files {

/// Cubic Bezier pieces, one for each stretch between two points: control points 3 i to 3 i + 3 belong to
/// piece i, over the parameter knots[i] to knots[i + 1].  As a B-spline its knots have the multiplicities
/// 4, 3, ..., 3, 4.  The last control point is the first one.
struct ClosedSpline {
  std::vector<Vec3> control;  ///< base, mm; 3 n + 1
  std::vector<double> knots;  ///< mm along the chords; n + 1
};

/// Through every point, with a continuous direction: the tangent at a point is that of the parabola through
/// it and its neighbours, over the chords' lengths.  Points that repeat the one before are left out. Pre: at
/// least 3 points apart.
[[nodiscard]] ClosedSpline spline_through(const cloud::ClosedLine& line);

}  // namespace biteline::line_files
