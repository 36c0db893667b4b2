// SPDX-License-Identifier: MIT
#include "host/transfer/align/icp.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "host/geometry/robust.hpp"

namespace biteline::transfer {
namespace {

using Step = ParameterStep;

// Steps below these move nothing on a shoe by more than 3 um.  Pairs change in whole surfels, so the last
// steps may go to and fro by about 1 um and never end.
constexpr double k_done_mm = 2e-3;
constexpr double k_done_rad = 1e-5;
constexpr double k_done_ratio = 1e-5;
constexpr double k_no_size = 0.6;  // no shoe is graded so far: the fit has run away
constexpr int k_full_steps = 20;
constexpr double k_facing_pitches = 1.5;
// Geman-McClure: residuals of this many robust standard deviations weigh a quarter.
constexpr double k_kernel_sigmas = 3.0;
constexpr std::size_t k_min_pairs = 20;
// A shoe's height is fixed a hundredth as well as its width: it takes 3 % longer.
constexpr double k_damping_ratio = 3e-4;

double square(double value) {
  return value * value;
}

/// How a point beside the line moves with the parameters, in the source's frame: [I, -hat(s), the grade's], s
/// = grade(p).
LineJacobian point_jacobian(const Grade& grade, const Vec3& point, const Foot& foot,
                            Eigen::Index parameters) {
  const Vec3 s = grade.apply(point, foot);
  LineJacobian J = LineJacobian::Zero(3, parameters);
  J.leftCols<3>().setIdentity();
  J.middleCols<3>(3) = -geometry::hat(s);
  if (parameters != parameter_count(Freedom::Graded)) return J;
  J(0, k_length) = grade.length * foot.place.x();
  J(1, k_width) = grade.width * foot.place.y();
  J(0, k_section_along) = grade.section_along * (point.x() - static_cast<double>(foot.place.x()));
  J(1, k_section_across) = grade.section_across * (point.y() - static_cast<double>(foot.place.y()));
  J(2, k_height) = grade.height * point.z();
  J.col(k_offset).head<2>() = foot.outward.cast<double>();
  return J;
}

void apply(const Step& step, const IcpOptions& options, Placement& placement) {
  placement.T_target_source = placement.T_target_source * geometry::exp_se3(step.head<6>());
  Grade& grade = placement.grade;
  if (options.freedom != Freedom::Graded) return;
  grade.length *= 1 + step[k_length];
  grade.width *= 1 + step[k_width];
  grade.section_along *= 1 + step[k_section_along];
  grade.section_across *= 1 + step[k_section_across];
  grade.height *= 1 + step[k_height];
  grade.offset_mm += step[k_offset];
}

bool settled(const Step& step) {
  if (step.head<3>().norm() > k_done_mm || step.segment<3>(3).norm() > k_done_rad) return false;
  for (Eigen::Index i = 6; i < step.size(); ++i) {
    if (std::abs(step[i]) > (i == k_offset ? k_done_mm : k_done_ratio)) return false;
  }
  return true;
}

/// Normal equations of one iteration.
struct NormalEquations {
  Freedom freedom;
  Information H;
  Step b;

  explicit NormalEquations(const IcpOptions& options) : freedom{options.freedom} {
    H = Information::Zero(parameter_count(freedom), parameter_count(freedom));
    b = Step::Zero(parameter_count(freedom));
  }

  /// `kernel_mm` 0: no robust weights.
  void add(const std::vector<Pair>& pairs, const Placement& placement, double kernel_mm,
           double weight_of_each) {
    if (freedom == Freedom::Rigid) {  // the usual one: six parameters, known to the compiler
      add_rigid(pairs, placement, kernel_mm, weight_of_each);
      return;
    }
    for (const Pair& pair : pairs) {
      const Step J =
          point_jacobian(placement.grade, pair.point, pair.foot, parameter_count(freedom)).transpose() *
          (placement.T_target_source.linear().transpose() * pair.direction);
      const double weight = weight_of_each / robust_divisor(pair, kernel_mm);
      H += weight * J * J.transpose();
      b -= weight * pair.residual_mm * J;
    }
  }

  /// A law that is known apart from all pairs.  `unit`: the weight of a residual whose variance is 1.
  void add(const GradingLaw::Pull& pull, double unit) {
    H += unit * pull.information;
    b += unit * pull.gradient;
  }

  /// Damping keeps a direction that the surface does not fix from running away on noise; it changes how fast
  /// a step arrives and not where.  The degeneracy itself is told from H.
  [[nodiscard]] Step solve() const {
    Information damped = H;
    for (Eigen::Index first = 0; first < H.rows(); first += 3) {
      const Eigen::Index count = std::min<Eigen::Index>(3, H.rows() - first);
      const double mean = H.diagonal().segment(first, count).mean();
      damped.diagonal().segment(first, count).array() +=
          k_damping_ratio * mean + std::numeric_limits<double>::min();
    }
    return damped.ldlt().solve(b);
  }

 private:
  static double robust_divisor(const Pair& pair, double kernel_mm) {
    if (kernel_mm <= 0) return 1;
    const double ratio = pair.residual_mm / kernel_mm;
    return (1 + ratio * ratio) * (1 + ratio * ratio);
  }

  /// Derivative of the residual: [n, s x n], n the direction in the source's frame, s = grade(p).
  void add_rigid(const std::vector<Pair>& pairs, const Placement& placement, double kernel_mm,
                 double weight_of_each) {
    const Mat3 R_source_target = placement.T_target_source.linear().transpose();
    Eigen::Matrix<double, 6, 6> squares = H;
    Eigen::Matrix<double, 6, 1> side = b;
    for (const Pair& pair : pairs) {
      const Vec3 n = R_source_target * pair.direction;
      Eigen::Matrix<double, 6, 1> J;
      J << n, placement.grade.apply(pair.point, pair.foot).cross(n);
      const double weight = weight_of_each / robust_divisor(pair, kernel_mm);
      squares.noalias() += (weight * J) * J.transpose();
      side -= weight * pair.residual_mm * J;
    }
    H = squares;
    b = side;
  }
};

Information information_of(const std::vector<Pair>& pairs, const Placement& placement,
                           const IcpOptions& options) {
  NormalEquations equations{options};
  equations.add(pairs, placement, 0, 1);
  return equations.H;
}

/// Both kinds of pairs under one placement.
struct AllPairs {
  std::vector<Pair> surface, rim, line;

  AllPairs(const Surfaces& surfaces, const Placement& placement, const IcpOptions& options)
      : surface{find_pairs(surfaces, placement, options)},
        rim{find_rim_pairs(surfaces, placement, options.rim_reach_mm)},
        line{find_line_pairs(surfaces, placement, options.reach_mm)} {}
};

/// The surface's errors hang together over the distance at which one last differs from the next, those of the
/// rim over a shorter one: what counts is how many independent pieces each has, not how many points.
double weight_of_each(const Surfels& source, std::size_t pairs, double pieces) {
  if (pairs == 0) return 0;
  const double surface_pieces_per_surfel = square(source.pitch_mm / k_surface_correlation_mm);
  return pieces / static_cast<double>(pairs) / surface_pieces_per_surfel;
}

/// Of a residual with variance 1, where a piece of the surface has that of two lasts and a surfel's pair
/// weighs 1.
double law_weight(const Surfels& source) {
  return square(k_last_sigma_mm) / square(source.pitch_mm / k_surface_correlation_mm);
}

void summarise(const AllPairs& pairs, const Surfaces& surfaces, const IcpOptions& options,
               IcpResult& result) {
  const double count = static_cast<double>(pairs.surface.size()),
               all = static_cast<double>(surfaces.source.size());
  double sum = 0;
  for (const Pair& pair : pairs.surface) sum += square(pair.residual_mm);
  result.rms_mm = pairs.surface.empty() ? 0 : std::sqrt(sum / count);
  result.robust_mm = robust_sigma_mm(pairs.surface);
  result.overlap_ratio = count / all;
  result.cost_mm2 = (sum + (all - count) * square(options.reach_mm)) / all;
  result.information = information_of(pairs.surface, result.placement, options);
  result.rim_information = information_of(pairs.rim, result.placement, options);
  result.line_information = information_of(pairs.line, result.placement, options);
  result.line_pairs = pairs.line.size();
  if (surfaces.source_rim != nullptr && surfaces.source_rim->size() > 0) {
    result.rim_overlap_ratio =
        static_cast<double>(pairs.rim.size()) / static_cast<double>(surfaces.source_rim->size());
    result.rim_mm = robust_sigma_mm(pairs.rim);
  }
}

}  // namespace

double robust_sigma_mm(const std::vector<Pair>& pairs) {
  if (pairs.empty()) return 0;
  std::vector<double> magnitudes;
  magnitudes.reserve(pairs.size());
  for (const Pair& pair : pairs) magnitudes.push_back(std::abs(pair.residual_mm));
  return geometry::k_sigma_per_mad * geometry::median_of(std::span<double>{magnitudes});
}

LineJacobian line_jacobian(const Grade& grade, const Vec3& point, const Vec2& outward,
                           Eigen::Index parameters) {
  const Foot foot{.place = point.head<2>().cast<float>(), .outward = outward.cast<float>()};
  return point_jacobian(grade, point, foot, parameters);
}

std::vector<Pair> find_pairs(const Surfaces& surfaces, const Placement& placement,
                             const IcpOptions& options) {
  const Surfels &source = surfaces.source, &target = surfaces.target;
  std::vector<Pair> pairs;
  pairs.reserve(source.size());
  const double facing_mm = k_facing_pitches * target.pitch_mm;
  for (std::uint32_t i = 0; i < source.size(); ++i) {
    const Vec3 point = source.positions[i].cast<double>();
    const Foot foot = source.foot(i);
    const Vec3 placed = placement.place(point, foot);
    const std::uint32_t near = surfaces.target_table.near(placed.cast<float>());
    if (near == NearestTable::k_none) continue;
    const Vec3 n_p = placement.place_normal(source.normals[i].cast<double>());
    const Vec3 n_q = target.normals[near].cast<double>();
    if (n_p.dot(n_q) < options.min_normal_cosine) continue;
    const Vec3 direction = (n_p + n_q).normalized();
    const Vec3 d = placed - target.positions[near].cast<double>();
    const double residual_mm = d.dot(direction);
    if (std::abs(residual_mm) > options.reach_mm) continue;
    if (d.squaredNorm() - square(residual_mm) > square(facing_mm)) continue;
    pairs.push_back({.source = i,
                     .target = near,
                     .point = point,
                     .foot = foot,
                     .direction = direction,
                     .residual_mm = residual_mm});
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
    pairs.push_back({.source = i,
                     .target = near,
                     .point = point,
                     .foot = foot,
                     .direction = direction,
                     .residual_mm = residual_mm});
  }
  return pairs;
}

std::vector<Pair> find_line_pairs(const Surfaces& surfaces, const Placement& placement, double reach_mm) {
  std::vector<Pair> pairs;
  if (surfaces.source_line == nullptr || surfaces.target_line == nullptr) return pairs;
  const std::vector<Vec3>& line = *surfaces.source_line;
  for (std::uint32_t i = 0; i < line.size(); ++i) {
    const Vec3 along = line[(i + 1) % line.size()] - line[i == 0 ? line.size() - 1 : i - 1];
    const Foot foot{.place = line[i].head<2>().cast<float>(),
                    .outward = Vec2{along.y(), -along.x()}.normalized().cast<float>()};
    const Vec3 placed = placement.place(line[i], foot);
    const LineBeside::Place beside = surfaces.target_line->at(placed);
    const Vec2 outward = beside.foot.outward.cast<double>();
    const double up_mm = placed.z() - beside.height_mm;
    const double out_mm = (placed.head<2>() - beside.foot.place.cast<double>()).dot(outward);
    if (std::hypot(up_mm, out_mm) > reach_mm) continue;
    const auto add = [&](const Vec3& direction, double residual_mm) {
      pairs.push_back({.source = i,
                       .target = 0,
                       .point = line[i],
                       .foot = foot,
                       .direction = direction,
                       .residual_mm = residual_mm});
    };
    add(Vec3::UnitZ(), up_mm);
    add({outward.x(), outward.y(), 0}, out_mm);
  }
  return pairs;
}

IcpResult run_icp(const Surfaces& surfaces, const Placement& start, const IcpOptions& options) {
  IcpResult result{.placement = start};
  AllPairs pairs{surfaces, start, options};
  for (;
       result.iterations < options.max_iterations && !result.converged && pairs.surface.size() >= k_min_pairs;
       ++result.iterations) {
    NormalEquations equations{options};
    const double sigma_mm = std::max(options.least_scale_mm, robust_sigma_mm(pairs.surface));
    equations.add(pairs.surface, result.placement, k_kernel_sigmas * sigma_mm, 1);
    const double rim_sigma_mm = std::max(options.least_scale_mm, robust_sigma_mm(pairs.rim));
    equations.add(pairs.rim, result.placement, k_kernel_sigmas * rim_sigma_mm,
                  weight_of_each(surfaces.source, pairs.rim.size(), k_rim_pieces));
    equations.add(pairs.line, result.placement, 0,
                  weight_of_each(surfaces.source, pairs.line.size(), k_line_pieces));
    if (options.freedom == Freedom::Graded)
      equations.add(options.law.pull(result.placement.grade), law_weight(surfaces.source));
    Step step = equations.solve();
    // Pairs are only known within reach: a longer step is a guess.
    const double length_mm = step.head<3>().norm();
    if (length_mm > options.reach_mm) step *= options.reach_mm / length_mm;
    // Pairs that change to and fro push the estimate to and fro: later steps count less, so that it comes to
    // rest between.
    if (result.iterations > k_full_steps) step *= static_cast<double>(k_full_steps) / result.iterations;
    apply(step, options, result.placement);
    if (result.placement.grade.largest_change() > k_no_size) break;
    result.converged = settled(step);
    pairs = AllPairs{surfaces, result.placement, options};
  }
  summarise(pairs, surfaces, options, result);
  return result;
}

}  // namespace biteline::transfer
