// SPDX-License-Identifier: MIT
#include "host/registration/icp.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

namespace biteline::registration {
namespace {

using Step = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, k_most_parameters, 1>;

// Steps below these move nothing on a shoe by more than 3 um.  Pairs change in whole surfels, so the last steps may go to
// and fro by about 1 um and never end.
constexpr double k_done_mm = 2e-3;
constexpr double k_done_rad = 1e-5;
constexpr double k_done_ratio = 1e-5;
constexpr double k_facing_pitches = 1.5;
// Geman-McClure: residuals of this many robust standard deviations weigh a quarter.
constexpr double k_kernel_sigmas = 3.0;
constexpr std::size_t k_min_pairs = 20;
// A shoe's height is fixed a hundredth as well as its width: it takes 3 % longer.
constexpr double k_damping_ratio = 3e-4;
// Lasts and stretched leather differ smoothly: 40 mm is half a shoe's height or width.
constexpr double k_surface_correlation_mm = 40;
// A collar is cut in one piece: as many independent places as it has sides and ends, twice.
constexpr double k_rim_pieces = 12;

double square(double value) { return value * value; }

double robust_sigma_mm(const std::vector<Pair>& pairs) {
  if (pairs.empty()) return 0;
  std::vector<double> magnitudes;
  magnitudes.reserve(pairs.size());
  for (const Pair& pair : pairs) magnitudes.push_back(std::abs(pair.residual_mm));
  const auto middle = magnitudes.begin() + static_cast<std::ptrdiff_t>(magnitudes.size() / 2);
  std::nth_element(magnitudes.begin(), middle, magnitudes.end());
  return 1.4826 * *middle;  // of a normal distribution: the standard deviation
}

/// Derivative of the residual by the parameters, in the source's frame: n . R [I, -hat(s)] xi with s = grade(p).
Step jacobian(const Placement& placement, const Pair& pair, Freedom freedom) {
  const Vec3 s = placement.grade.apply(pair.point, pair.foot);
  const Vec3 n = placement.T_target_source.linear().transpose() * pair.direction;
  Step J(parameter_count(freedom));
  J.head<3>() = n;
  J.segment<3>(3) = s.cross(n);
  if (freedom == Freedom::UniformScale) J[6] = n.dot(s);
  if (freedom == Freedom::Graded) {
    const double offset = n.x() * pair.foot.outward.x() + n.y() * pair.foot.outward.y();
    J[6] = n.x() * placement.grade.length * pair.foot.place.x();
    J[7] = n.y() * placement.grade.width * pair.foot.place.y();
    J[8] = n.dot(s) - J[6] - J[7] - placement.grade.offset_mm * offset;
    J[9] = offset;
  }
  return J;
}

void apply(const Step& step, Freedom freedom, Placement& placement) {
  placement.T_target_source = placement.T_target_source * geometry::exp_se3(step.head<6>());
  if (freedom == Freedom::Rigid) return;
  placement.grade.length *= 1 + step[6];
  placement.grade.width *= 1 + (freedom == Freedom::Graded ? step[7] : step[6]);
  placement.grade.section *= 1 + (freedom == Freedom::Graded ? step[8] : step[6]);
  if (freedom == Freedom::Graded) placement.grade.offset_mm += step[9];
}

bool settled(const Step& step) {
  if (step.head<3>().norm() > k_done_mm || step.segment<3>(3).norm() > k_done_rad) return false;
  for (Eigen::Index i = 6; i < step.size(); ++i) {
    if (std::abs(step[i]) > (i < 9 ? k_done_ratio : k_done_mm)) return false;
  }
  return true;
}

/// Normal equations of one iteration.
struct NormalEquations {
  Freedom freedom;
  Information H;
  Step b;

  explicit NormalEquations(Freedom which) : freedom{which} {
    H = Information::Zero(parameter_count(freedom), parameter_count(freedom));
    b = Step::Zero(parameter_count(freedom));
  }

  /// `kernel_mm` 0: no robust weights.
  void add(const std::vector<Pair>& pairs, const Placement& placement, double kernel_mm, double weight_of_each) {
    for (const Pair& pair : pairs) {
      const Step J = jacobian(placement, pair, freedom);
      double weight = weight_of_each;
      if (kernel_mm > 0) {
        const double ratio = pair.residual_mm / kernel_mm;
        weight /= (1 + ratio * ratio) * (1 + ratio * ratio);
      }
      H += weight * J * J.transpose();
      b -= weight * pair.residual_mm * J;
    }
  }

  /// Damping keeps a direction that the surface does not fix from running away on noise; it changes how fast a step
  /// arrives and not where.  The degeneracy itself is told from H.
  [[nodiscard]] Step solve() const {
    Information damped = H;
    for (Eigen::Index first = 0; first < H.rows(); first += 3) {
      const Eigen::Index count = std::min<Eigen::Index>(3, H.rows() - first);
      const double mean = H.diagonal().segment(first, count).mean();
      damped.diagonal().segment(first, count).array() += k_damping_ratio * mean + std::numeric_limits<double>::min();
    }
    return damped.ldlt().solve(b);
  }
};

Information information_of(const std::vector<Pair>& pairs, const Placement& placement, Freedom freedom) {
  NormalEquations equations{freedom};
  equations.add(pairs, placement, 0, 1);
  return equations.H;
}

/// Both kinds of pairs under one placement.
struct AllPairs {
  std::vector<Pair> surface, rim;

  AllPairs(const Surfaces& surfaces, const Placement& placement, const IcpOptions& options)
      : surface{find_pairs(surfaces, placement, options)},
        rim{find_rim_pairs(surfaces, placement, options.rim_reach_mm)} {}
};

/// The surface's errors hang together over the distance at which one last differs from the next, those of the rim over a
/// shorter one: what counts is how many independent pieces each has, not how many points.
double rim_weight(const Surfels& source, std::size_t rim_pairs) {
  if (rim_pairs == 0) return 0;
  const double surface_pieces_per_surfel = square(source.pitch_mm / k_surface_correlation_mm);
  const double rim_pieces_per_pair = k_rim_pieces / static_cast<double>(rim_pairs);
  return rim_pieces_per_pair / surface_pieces_per_surfel;
}

void summarise(const AllPairs& pairs, const Surfaces& surfaces, const IcpOptions& options, IcpResult& result) {
  const double count = static_cast<double>(pairs.surface.size()), all = static_cast<double>(surfaces.source.size());
  double sum = 0;
  for (const Pair& pair : pairs.surface) sum += square(pair.residual_mm);
  result.rms_mm = pairs.surface.empty() ? 0 : std::sqrt(sum / count);
  result.robust_mm = robust_sigma_mm(pairs.surface);
  result.overlap_ratio = count / all;
  result.cost_mm2 = (sum + (all - count) * square(options.reach_mm)) / all;
  result.information = information_of(pairs.surface, result.placement, options.freedom);
  result.rim_information = information_of(pairs.rim, result.placement, options.freedom);
  if (surfaces.source_rim != nullptr && surfaces.source_rim->size() > 0) {
    result.rim_overlap_ratio =
        static_cast<double>(pairs.rim.size()) / static_cast<double>(surfaces.source_rim->size());
    result.rim_mm = robust_sigma_mm(pairs.rim);
  }
}

}  // namespace

std::vector<Pair> find_pairs(const Surfaces& surfaces, const Placement& placement, const IcpOptions& options) {
  const auto& [source, target, table, source_rim, target_rim] = surfaces;
  std::vector<Pair> pairs;
  pairs.reserve(source.size());
  const double facing_mm = k_facing_pitches * target.pitch_mm;
  for (std::uint32_t i = 0; i < source.size(); ++i) {
    const Vec3 point = source.positions[i].cast<double>();
    const Foot foot = source.foot(i);
    const Vec3 placed = placement.place(point, foot);
    const std::uint32_t near = table.near(placed.cast<float>());
    if (near == NearestTable::k_none) continue;
    const Vec3 n_p = placement.place_normal(source.normals[i].cast<double>());
    const Vec3 n_q = target.normals[near].cast<double>();
    if (n_p.dot(n_q) < options.min_normal_cosine) continue;
    const Vec3 direction = (n_p + n_q).normalized();
    const Vec3 d = placed - target.positions[near].cast<double>();
    const double residual_mm = d.dot(direction);
    if (std::abs(residual_mm) > options.reach_mm) continue;
    if (d.squaredNorm() - square(residual_mm) > square(facing_mm)) continue;
    pairs.push_back({.source = i, .target = near, .point = point, .foot = foot, .direction = direction, .residual_mm = residual_mm});
  }
  return pairs;
}

std::vector<Pair> find_rim_pairs(const Surfaces& surfaces, const Placement& placement, double reach_mm) {
  std::vector<Pair> pairs;
  if (surfaces.source_rim == nullptr || surfaces.target_rim == nullptr) return pairs;
  const Rim &source = *surfaces.source_rim, &target = *surfaces.target_rim;
  for (std::uint32_t i = 0; i < source.size(); ++i) {
    const Vec3 point = source.positions[i].cast<double>();
    const Foot foot = source.foot(i);
    const Eigen::Vector3f placed = placement.place(point, foot).cast<float>();
    const std::uint32_t near = nearest_on(target, placed);
    const Vec3 d = (placed - target.positions[near]).cast<double>();
    if (d.squaredNorm() > square(reach_mm + target.spacing_mm)) continue;
    const Vec3 direction = target.across[near].cast<double>();
    const double residual_mm = d.dot(direction);
    if (std::abs(residual_mm) > reach_mm) continue;
    pairs.push_back({.source = i, .target = near, .point = point, .foot = foot, .direction = direction, .residual_mm = residual_mm});
  }
  return pairs;
}

IcpResult run_icp(const Surfaces& surfaces, const Placement& start, const IcpOptions& options) {
  IcpResult result{.placement = start};
  AllPairs pairs{surfaces, start, options};
  for (; result.iterations < options.max_iterations && !result.converged && pairs.surface.size() >= k_min_pairs;
       ++result.iterations) {
    NormalEquations equations{options.freedom};
    const double sigma_mm = std::max(options.least_scale_mm, robust_sigma_mm(pairs.surface));
    equations.add(pairs.surface, result.placement, k_kernel_sigmas * sigma_mm, 1);
    const double rim_sigma_mm = std::max(options.least_scale_mm, robust_sigma_mm(pairs.rim));
    equations.add(pairs.rim, result.placement, k_kernel_sigmas * rim_sigma_mm,
                  rim_weight(surfaces.source, pairs.rim.size()));
    Step step = equations.solve();
    // Pairs are only known within reach: a longer step is a guess.
    const double length_mm = step.head<3>().norm();
    if (length_mm > options.reach_mm) step *= options.reach_mm / length_mm;
    apply(step, options.freedom, result.placement);
    result.converged = settled(step);
    pairs = AllPairs{surfaces, result.placement, options};
  }
  summarise(pairs, surfaces, options, result);
  return result;
}

}  // namespace biteline::registration
