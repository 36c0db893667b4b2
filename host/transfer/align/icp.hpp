// SPDX-License-Identifier: MIT
#pragma once
/// \file Iterative closest points between two surfaces of which only a part is common: the local step of
/// registration.

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "common/geometry/se3.hpp"
#include "host/transfer/align/nearest_table.hpp"
#include "host/transfer/align/rim.hpp"
#include "host/transfer/align/surfels.hpp"

namespace biteline::transfer {

/// How a shoe of one size becomes one of another: its outline by length and width, then moved outward by an
/// even offset (the line lies inside the outline that is graded, by the depth of the groove); its upright
/// sections as a whole.  A last graded by length only keeps its sections (section 1), an enlarged one has all
/// three alike and no offset.
struct Grade {
  double length{1}, width{1};
  double section{1};  ///< of the wall's way in and out beside the outline
  double height{1};
  double offset_mm{0};

  /// A point of the shoe frame and the line's place beside it.
  [[nodiscard]] Vec3 apply(const Vec3& point, const Foot& foot) const {
    const double x = foot.place.x(), y = foot.place.y();
    return {length * x + section * (point.x() - x) + offset_mm * foot.outward.x(),
            width * y + section * (point.y() - y) + offset_mm * foot.outward.y(), height * point.z()};
  }
  /// The outline's normal turns with the outline; its rise is the section's.
  [[nodiscard]] Vec3 apply_normal(const Vec3& normal) const {
    if (is_none()) return normal.normalized();
    const Vec2 level{normal.x() / length, normal.y() / width};
    const double before = normal.head<2>().norm(), after = level.norm();
    if (after <= 0) return normal;
    return Vec3{level.x() * before / after, level.y() * before / after, normal.z() * section / height}
        .normalized();
  }
  [[nodiscard]] bool is_none() const {
    return length == 1 && width == 1 && section == 1 && height == 1 && offset_mm == 0;
  }
  [[nodiscard]] double largest_change() const {
    return std::max({std::abs(length - 1), std::abs(width - 1), std::abs(section - 1), std::abs(height - 1)});
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

/// What may change.  Graded: length, width, section, height and offset, each for itself or tied.
enum class Freedom { Rigid, Graded };

/// How the sections follow the length: factor = 1 + share * (length - 1); 0: they stay, 1: they grow as it
/// does. Without a share it is free.
struct GradeTie {
  std::optional<double> section_share{};
  std::optional<double> height_share{};

  [[nodiscard]] int free_count() const { return (section_share ? 0 : 1) + (height_share ? 0 : 1); }
};

inline constexpr int k_most_parameters = 11;
[[nodiscard]] constexpr int parameter_count(Freedom freedom) {
  return freedom == Freedom::Rigid ? 6 : k_most_parameters;
}

struct IcpOptions {
  double reach_mm{5};             ///< pairs farther apart do not count
  double min_normal_cosine{0.7};  ///< pairs whose normals differ more do not count
  double least_scale_mm{0.05};    ///< the robust kernel is never tighter: the roughness of a surface
  int max_iterations{30};
  Freedom freedom{Freedom::Rigid};
  GradeTie tie{};          ///< of Freedom::Graded
  double rim_reach_mm{1};  ///< rims farther apart do not count
};

/// Information of the estimate's parameters: right perturbation [rho; theta] of T_target_source (mm, rad),
/// then relative changes of the grade (uniform: 1, graded: length, width, section, height) and its offset
/// (mm).  Unit weight: divide by the variance of a residual.
using Information =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, k_most_parameters, k_most_parameters>;

/// How a point of the sample's line moves with the parameters, source's frame.
using LineJacobian = Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, k_most_parameters>;
[[nodiscard]] LineJacobian line_jacobian(const Grade& grade, const Vec3& point, const GradeTie& tie,
                                         Eigen::Index parameters);

struct IcpResult {
  Placement placement{};
  bool converged{false};
  int iterations{0};
  double rms_mm{0};         ///< of all pairs within reach, without robust weights
  double robust_mm{0};      ///< 1.4826 times the median of |residual|
  double overlap_ratio{0};  ///< share of the source's surfels that have a pair
  double cost_mm2{0};  ///< mean over all source surfels of min(residual², reach²), no pair counting as reach²
  double rim_mm{0};  ///< 1.4826 times the median of |residual| over the rims' pairs
  double rim_overlap_ratio{0};
  Information information{};  ///< of the surfels' pairs, each of weight 1
  Information rim_information{};
};

/// What is moved, and what it is moved onto.  References only for the call.
struct Surfaces {
  const Surfels& source;
  const Surfels& target;
  const NearestTable& target_table;
  const Rim* source_rim{nullptr};  ///< both or neither
  const Rim* target_rim{nullptr};
};

/// Symmetric objective (Rusinkiewicz 2019, "A symmetric objective function for ICP", eq. (9)): the residual
/// (p - q) . (n_p + n_q) vanishes whenever p and q lie on a common circle, so neighbouring points on a curved
/// surface do not pull, the basin is wide and surfels of 2 mm do for 0.01 mm.  Geman-McClure weights with a
/// scale from the median, Gauss-Newton on the right perturbation. A pair counts only when it faces: when the
/// foot of p lies within 1.5 pitches of q.  So what overhangs the other surface's border has no pair.
[[nodiscard]] IcpResult run_icp(const Surfaces& surfaces, const Placement& start, const IcpOptions& options);

/// One source point and its counterpart under a placement.
struct Pair {
  std::uint32_t source;  ///< index in the source's surfels or rim
  std::uint32_t target;
  Vec3 point;  ///< the source's point, own frame
  Foot foot;
  Vec3 direction;      ///< unit, target's frame: in which the residual is measured
  double residual_mm;  ///< (placed point - target) . direction
};

/// 1.4826 times the median of |residual|: of a normal distribution, its standard deviation.
[[nodiscard]] double robust_sigma_mm(const std::vector<Pair>& pairs);

/// The pairs that run_icp() would use.
[[nodiscard]] std::vector<Pair> find_pairs(const Surfaces& surfaces, const Placement& placement,
                                           const IcpOptions& options);

/// Pairs of the rims (see rim.hpp); none where a rim is missing.
[[nodiscard]] std::vector<Pair> find_rim_pairs(const Surfaces& surfaces, const Placement& placement,
                                               double reach_mm);

}  // namespace biteline::transfer
