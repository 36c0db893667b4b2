// SPDX-License-Identifier: MIT
#pragma once
/// \file Iterative closest points between two surfaces of which only a part is common: the local step of registration.

#include <Eigen/Core>

#include "common/geometry/se3.hpp"
#include "host/registration/nearest_table.hpp"
#include "host/registration/rim.hpp"
#include "host/registration/surfels.hpp"

namespace biteline::registration {

/// p_target = T_target_source * (scale ∘ p_source), scale along the source's own axes.  A negative scale_y mirrors.
struct Placement {
  SE3 T_target_source{SE3::Identity()};
  Vec3 scale{Vec3::Ones()};

  [[nodiscard]] Vec3 place(const Vec3& point) const { return T_target_source * scale.cwiseProduct(point); }
  /// Normals go by the inverse transpose, so that they stay at right angles to the surface.
  [[nodiscard]] Vec3 place_normal(const Vec3& normal) const {
    return (T_target_source.linear() * normal.cwiseQuotient(scale)).normalized();
  }
};

/// What may change.  Graded: one factor along each axis of the source (length, girth, height).
enum class Freedom { Rigid, UniformScale, Graded };

[[nodiscard]] constexpr int parameter_count(Freedom freedom) {
  return freedom == Freedom::Rigid ? 6 : freedom == Freedom::UniformScale ? 7 : 9;
}

struct IcpOptions {
  double reach_mm{5};            ///< pairs farther apart do not count
  double min_normal_cosine{0.7}; ///< pairs whose normals differ more do not count
  double least_scale_mm{0.05};   ///< the robust kernel is never tighter: the roughness of a surface
  int max_iterations{30};
  Freedom freedom{Freedom::Rigid};
  double rim_reach_mm{1};        ///< rims farther apart do not count
};

/// Information of the estimate's parameters: right perturbation [rho; theta] of T_target_source (mm, rad), then relative
/// changes of the scale (uniform: 1, graded: x, y, z).  Unit weight: divide by the variance of a residual.
using Information = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 9, 9>;

struct IcpResult {
  Placement placement{};
  bool converged{false};
  int iterations{0};
  double rms_mm{0};         ///< of all pairs within reach, without robust weights
  double robust_mm{0};      ///< 1.4826 times the median of |residual|
  double overlap_ratio{0};  ///< share of the source's surfels that have a pair
  double cost_mm2{0};       ///< mean over all source surfels of min(residual², reach²), no pair counting as reach²
  double rim_mm{0};         ///< 1.4826 times the median of |residual| over the rims' pairs
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
/// (p - q) . (n_p + n_q) vanishes whenever p and q lie on a common circle, so neighbouring points on a curved surface do
/// not pull, the basin is wide and surfels of 2 mm do for 0.01 mm.  Geman-McClure weights with a scale from the median,
/// Gauss-Newton on the right perturbation.
/// A pair counts only when it faces: when the foot of p lies within 1.5 pitches of q.  So what overhangs the other
/// surface's border has no pair.
[[nodiscard]] IcpResult run_icp(const Surfaces& surfaces, const Placement& start, const IcpOptions& options);

/// One source point and its counterpart under a placement.
struct Pair {
  std::uint32_t source;    ///< index in the source's surfels or rim
  std::uint32_t target;
  Vec3 point;              ///< the source's point, own frame
  Vec3 direction;          ///< unit, target's frame: in which the residual is measured
  double residual_mm;      ///< (placed point - target) . direction
};

/// The pairs that run_icp() would use.
[[nodiscard]] std::vector<Pair> find_pairs(const Surfaces& surfaces, const Placement& placement, const IcpOptions& options);

/// Pairs of the rims (see rim.hpp); none where a rim is missing.
[[nodiscard]] std::vector<Pair> find_rim_pairs(const Surfaces& surfaces, const Placement& placement, double reach_mm);

}  // namespace biteline::registration
