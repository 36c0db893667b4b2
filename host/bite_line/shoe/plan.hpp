// SPDX-License-Identifier: MIT
#pragma once
/// \file The shoe seen from above: convex hull, its tightest rectangle, and the smooth closed outline.

#include <cstdint>
#include <span>
#include <vector>

#include "common/geometry/se3.hpp"
#include "host/bite_line/shoe/outline_lookup.hpp"

namespace biteline::bite_line {

/// Convex hull, anticlockwise, without collinear points (Andrew's monotone chain).
[[nodiscard]] std::vector<Vec2> convex_hull(std::vector<Vec2> points);

struct PlanBox {
  Vec2 long_axis{Vec2::UnitX()};
  double length_mm{0};
  double width_mm{0};
  Vec2 centre{Vec2::Zero()};
  Vec2 area_centroid{Vec2::Zero()};
};

/// The rectangle of least area round a hull (one side lies on a hull edge).  Pre: at least 3 points.
[[nodiscard]] PlanBox tightest_box(std::span<const Vec2> hull);

/// A smooth closed curve in plan, anticlockwise, with an arc length s and outward normals: the virtual
/// cylinder on which the shoe's side is unrolled.
///
/// Every place near it has coordinates s (along) and o (outwards); at constant s one moves in the upright
/// plane along the outline's normal.
class Outline {
 public:
  struct Config {
    double spacing_mm{1.0};
    double smoothing_mm{
        6.0};  ///< standard deviation along the curve; keeps corners of a hull from folding the sections
    double reach_mm{48.0};  ///< how far inwards and outwards locate() answers
  };

  /// `curve` closed, anticlockwise, any spacing.
  Outline(std::span<const Vec2> curve, const Config& config);

  /// `places` of as many points in shoe.
  void locate(std::span<const Eigen::Vector3f> points, std::span<OutlinePlace> places) const {
    lookup_.locate(points, places);
  }
  [[nodiscard]] OutlinePlace locate(const Eigen::Vector3f& point) const;

  [[nodiscard]] Vec2 point(double s_mm) const;
  [[nodiscard]] Vec2 normal(double s_mm) const;                 ///< outward unit normal
  [[nodiscard]] Vec2 outwards(double s_mm, double o_mm) const;  ///< so far out of point(s_mm)
  /// Curvature of the curve, 1/mm, positive where convex.
  [[nodiscard]] double bend_per_mm(double s_mm) const;
  [[nodiscard]] double length_mm() const { return length_mm_; }
  [[nodiscard]] int samples() const { return static_cast<int>(points_.size()); }
  [[nodiscard]] double spacing_mm() const { return length_mm_ / static_cast<double>(points_.size()); }

 private:
  struct Between {
    std::size_t first, second;
    double fraction;
  };
  [[nodiscard]] Between between(double s_mm) const;

  std::vector<Vec2> points_;
  std::vector<Vec2> normals_;
  std::vector<double> bend_per_mm_;
  double length_mm_{0};
  OutlineLookup lookup_;
};

}  // namespace biteline::bite_line
