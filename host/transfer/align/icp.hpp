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
#include "host/transfer/align/grade.hpp"
#include "host/transfer/align/line_beside.hpp"
#include "host/transfer/align/nearest_table.hpp"
#include "host/transfer/align/rim.hpp"
#include "host/transfer/align/surfels.hpp"

namespace biteline::transfer {

/// What may change.  Graded: its factors and offset, too, weighed against a law.
enum class Freedom { Rigid, Graded };
[[nodiscard]] constexpr int parameter_count(Freedom freedom) {
  return freedom == Freedom::Rigid ? 6 : k_most_parameters;
}

struct IcpOptions {
  double reach_mm{5};             ///< pairs farther apart do not count
  double min_normal_cosine{0.7};  ///< pairs whose normals differ more do not count
  double least_scale_mm{0.05};    ///< the robust kernel is never tighter: the roughness of a surface
  int max_iterations{30};
  Freedom freedom{Freedom::Rigid};
  GradingLaw law{usual_law()};  ///< of Freedom::Graded
  double rim_reach_mm{1};       ///< rims farther apart do not count
};

/// How a point of the sample's line moves with the parameters, source's frame.
using LineJacobian = Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, k_most_parameters>;
[[nodiscard]] LineJacobian line_jacobian(const Grade& grade, const Vec3& point, const Vec2& outward,
                                         Eigen::Index parameters);

// A collar is cut in one piece: as many independent places as it has sides and ends, twice.  Lines of two
// samples differ as their lasts do, over some 40 mm, each up and out.
inline constexpr double k_rim_pieces = 12, k_line_pieces = 30;
// Lasts and stretched leather differ smoothly: 40 mm is half a shoe's height or width.
inline constexpr double k_surface_correlation_mm = 40;
inline constexpr double k_last_sigma_mm = 0.1;  ///< a last that seems to differ less does so by chance
inline constexpr double k_rim_sigma_mm = 0.1;   ///< a collar's edge, as cut and scanned

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
  std::size_t line_pairs{0};
  Information information{};  ///< of the surfels' pairs, each of weight 1: divide by a residual's variance
  Information rim_information{};
  Information line_information{};
};

/// What is moved, and what it is moved onto.  References only for the call.
struct Surfaces {
  const Surfels& source;
  const Surfels& target;
  const NearestTable& target_table;
  const Rim* source_rim{nullptr};  ///< both or neither
  const Rim* target_rim{nullptr};
  const std::vector<Vec3>* source_line{nullptr};  ///< bite lines of two samples; both or neither
  const LineBeside* target_line{nullptr};
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

/// Of each place of the source's line two: its height and how far out it is, against the target's line beside
/// it; none where a line is missing.
[[nodiscard]] std::vector<Pair> find_line_pairs(const Surfaces& surfaces, const Placement& placement,
                                                double reach_mm);

}  // namespace biteline::transfer
