// SPDX-License-Identifier: MIT
#pragma once
/// \file The closed outline of a made shoe, seen from above: smooth, by arc length, anticlockwise.

#include <cstdint>
#include <vector>

#include "common/geometry/se3.hpp"

namespace biteline::sim {

/// What an outline is drawn from.  Only a foot's has a heel and a toe.
enum class OutlineForm : std::uint8_t {
  Foot,
  Box,   ///< straight sides, rounded corners
  Oval,  ///< an ellipse
  Iron,  ///< pointed in front, cut off behind
};

struct OutlineShape {
  double length_mm{290};
  double width_ratio{1.0};  ///< about a common foot's breadth; of other forms: breadth over length
  bool left_foot{false};
  std::vector<double> jitter{};  ///< relative sideways change of each control point, may be empty
  OutlineForm form{OutlineForm::Foot};
  double waist_ratio{1.0};  ///< of a common foot's breadth at the waist: shanks are narrower
  double toe_ratio{1.0};    ///< of a common foot's breadth at the toe: below 1 pointed, above 1 square
};

/// Closed uniform cubic B-spline: curvature is continuous, so sections do not jump.  Heel at x = 0, toe at x
/// = length.
class Outline {
 public:
  /// A place of the outline: point, direction of travel, outward normal (both unit, horizontal), signed
  /// curvature (positive where convex).
  struct Place {
    Vec2 point;
    Vec2 tangent;
    Vec2 normal;
    double curvature_per_mm;
  };

  explicit Outline(const OutlineShape& shape);

  [[nodiscard]] double perimeter_mm() const { return perimeter_mm_; }
  [[nodiscard]] double length_mm() const { return length_mm_; }
  /// `s_mm` may be any number: the outline repeats.
  [[nodiscard]] Place at(double s_mm) const;
  /// Shortest signed way along the outline from `from_mm` to `to_mm`.
  [[nodiscard]] double way_mm(double from_mm, double to_mm) const;

  static constexpr int k_control_points = 24;

 private:
  struct Derivatives {
    Vec2 value, first, second;
  };
  [[nodiscard]] Derivatives evaluate(double parameter) const;

  std::vector<Vec2> control_;
  std::vector<double> arc_mm_;  ///< arc length at evenly spaced spline parameters
  double perimeter_mm_{0};
  double length_mm_{0};
};

}  // namespace biteline::sim
