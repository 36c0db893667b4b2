// SPDX-License-Identifier: MIT
#pragma once
/// \file How a shoe of one size becomes one of another, and by what law a factory grades.

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>

#include "common/geometry/se3.hpp"
#include "host/transfer/align/surfels.hpp"

namespace biteline::transfer {

/// How a shoe of one size becomes one of another: its outline by length and width, then moved outward by an
/// even offset (the line lies inside the outline that is graded, by the depth of the groove); what lies
/// beside the outline, in and out, by factors of its own along the shoe and across it; heights by one more.
/// A last graded by length only keeps its sections (1), an enlarged one has all factors alike and no offset.
struct Grade {
  double length{1}, width{1};
  double section_along{1}, section_across{1};
  double height{1};
  double offset_mm{0};

  /// A point of the shoe frame and the line's place beside it.
  [[nodiscard]] Vec3 apply(const Vec3& point, const Foot& foot) const {
    const double x = foot.place.x(), y = foot.place.y();
    return {length * x + section_along * (point.x() - x) + offset_mm * foot.outward.x(),
            width * y + section_across * (point.y() - y) + offset_mm * foot.outward.y(), height * point.z()};
  }
  /// The outline's normal turns with the outline; its rise is the section's.
  [[nodiscard]] Vec3 apply_normal(const Vec3& normal) const {
    if (is_none()) return normal.normalized();
    const Vec2 level{normal.x() / length, normal.y() / width};
    const double before = normal.head<2>().norm(), after = level.norm();
    if (after <= 0) return normal;
    // Of a section that leans towards `level`: how much longer its way in and out is.
    const double section =
        (section_along * normal.x() * normal.x() + section_across * normal.y() * normal.y()) /
        (before * before);
    return Vec3{level.x() * before / after, level.y() * before / after, normal.z() * section / height}
        .normalized();
  }
  [[nodiscard]] bool is_none() const {
    return length == 1 && width == 1 && section_along == 1 && section_across == 1 && height == 1 &&
           offset_mm == 0;
  }
  [[nodiscard]] double largest_change() const {
    return std::max({std::abs(length - 1), std::abs(width - 1), std::abs(section_along - 1),
                     std::abs(section_across - 1), std::abs(height - 1)});
  }
};

/// p_target = T_target_source * grade(p_source).
struct Placement {
  SE3 T_target_source{SE3::Identity()};
  Grade grade{};

  [[nodiscard]] Vec3 place(const Vec3& point, const Foot& foot) const {
    return T_target_source * grade.apply(point, foot);
  }
  [[nodiscard]] Vec3 place_normal(const Vec3& normal) const {
    return T_target_source.linear() * grade.apply_normal(normal);
  }
};

/// Behind the six of the motion: relative changes of the five factors, and the offset, mm.
enum GradeParameter : std::uint8_t {
  k_length = 6,
  k_width,
  k_section_along,
  k_section_across,
  k_height,
  k_offset
};
inline constexpr int k_most_parameters = 12;

/// Information of a placement's parameters: right perturbation [rho; theta] of T_target_source (mm, rad),
/// then, where it is graded, as GradeParameter.
using Information =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, k_most_parameters, k_most_parameters>;
using ParameterStep = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, k_most_parameters, 1>;

/// A factory grades by a rule: each factor takes a share of the length's relative change, and the offset so
/// many millimetres for a change of one.  What the two scans show is weighed against it: a wall tells only
/// weakly how much higher a shoe of another size is, and a hundredth is 0.4 mm at the line.
struct GradingLaw {
  struct Share {
    double mean, sigma;
    double bend{0};  ///< 1 sigma of how much the share changes for a change of one in length
  };
  Share width, section_along, section_across, height, offset_mm;
  double taught_at{0};  ///< change of length to the sample that taught it with this one; a bend is none there

  /// What a size is off its law: lasts are rounded to such.
  static constexpr double k_factor_sigma = 5e-4, k_offset_sigma_mm = 0.05;

  /// A grade against this law.
  struct Pull {
    Information information;  ///< 1 / variance of each parameter
    ParameterStep gradient;   ///< what it pulls them by: of its log probability
  };
  [[nodiscard]] Pull pull(const Grade& grade) const;
  /// Sum of the five squares of how far a grade is off, in sigmas.
  [[nodiscard]] double misfit(const Grade& grade) const;
  /// The grade of that length by this law alone.
  [[nodiscard]] Grade at_length(double length) const;
};

/// Where nobody has taught a factory's own.
[[nodiscard]] GradingLaw usual_law();

}  // namespace biteline::transfer
