// SPDX-License-Identifier: MIT
#pragma once
/// \file Whether an outline is a shoe's: broad at the ball of the foot, narrower at waist and heel, round at
/// both ends.

#include <array>
#include <span>

#include "common/geometry/se3.hpp"

namespace biteline::bite_line {

/// Three measures of an outline from above, with the broader half in front.
struct PlanShape {
  double broadest_at{
      0.5};                ///< over the length from the heel: middle of what has 98 % of the greatest breadth
  double end_breadth{1};   ///< of the broader end, at 3 % of the length from it, over the greatest
  double heel_breadth{1};  ///< at a tenth of the length from the heel, over the greatest
};

/// `curve` closed, in any axes: its own are those of the area within.
[[nodiscard]] PlanShape plan_shape(std::span<const Vec2> curve);

/// How far an outline is from what shoes' are: Mahalanobis distance of its three measures.
///
/// Mean and covariance are those of made shoes and of shoes of public origin, each lot half, as fitted by
/// tests/bench/line/fit_outline.py to what bench_line_outline writes.  It learns from shoes alone: a thing of
/// a kind that nobody thought of is as far away as a box.
struct ShoeOutlines {
  std::array<double, 3> mean{0.6972, 0.4495, 0.6605};  ///< in the order of PlanShape
  /// Rows of the lower triangle W with W (x - mean) of unit covariance.
  std::array<double, 6> whiten{46.759, 5.187, 16.538, 15.770, -8.400, 17.337};
  double limit{5.3};     ///< at which an outline is a shoe's with one half
  double softness{0.5};  ///< e times less likely for each
};
[[nodiscard]] double distance_to_shoes(const PlanShape& shape, const ShoeOutlines& shoes = {});

/// Probability that it is a shoe's.
[[nodiscard]] double shoe_chance(const PlanShape& shape, const ShoeOutlines& shoes = {});

}  // namespace biteline::bite_line
