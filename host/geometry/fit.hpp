// SPDX-License-Identifier: MIT
#pragma once
/// \file Planes and lines through points, by least squares.

#include <cstddef>
#include <optional>
#include <span>

#include "common/geometry/se3.hpp"

namespace biteline::geometry {

/// The plane of least squares through points: principal axes about their mean.
struct PlaneFit {
  Vec3 mean;
  Vec3 normal;      ///< unit, either sign
  Vec3 spread_mm2;  ///< variances along the axes, the least first: that of the plane's thickness
};
/// Nothing through fewer than three points.
[[nodiscard]] std::optional<PlaneFit> fit_plane(std::span<const Vec3> points);

/// Straight line y = middle + slope (x - mean x), point by point.
class LineSums {
 public:
  void add(double x, double y) {
    n_ += 1;
    x_ += x;
    xx_ += x * x;
    y_ += y;
    xy_ += x * y;
  }
  [[nodiscard]] double count() const { return n_; }
  /// Nothing where all points lie at one x.
  [[nodiscard]] std::optional<double> slope() const;

 private:
  double n_{0}, x_{0}, xx_{0}, y_{0}, xy_{0};
};

}  // namespace biteline::geometry
