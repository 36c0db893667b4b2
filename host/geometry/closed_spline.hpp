// SPDX-License-Identifier: MIT
#pragma once
/// \file A smooth closed function through values at uneven places.

#include <cstddef>
#include <span>
#include <vector>

namespace biteline::geometry {

/// Interpolating cubic spline on a circle: twice continuously differentiable.  At three samples to a period
/// it still has nine tenths of a wave's slope, where straight lines have half.
class ClosedSpline {
 public:
  struct Knot {
    double at_mm{0};
    double value{0};
  };
  /// `knots` ascending within one turn, at least three, no two at one place.
  ClosedSpline(std::vector<Knot> knots, double turn_mm);

  struct Sample {
    double value{0};
    double slope{0};
    double interval_mm{0};  ///< between the two knots around the place
  };
  [[nodiscard]] Sample at(double place_mm) const;
  /// `count` samples at 0, `step_mm` and so on, within one turn.
  [[nodiscard]] std::vector<Sample> every(double step_mm, std::size_t count) const;

 private:
  /// `above`: the first knot beyond the place.
  [[nodiscard]] Sample before_knot(std::size_t above, double place_mm) const;

  std::vector<Knot> knots_;
  std::vector<double> bend_;  ///< second derivative at each knot
  double turn_mm_;
};

}  // namespace biteline::geometry
