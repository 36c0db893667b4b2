// SPDX-License-Identifier: MIT
#include "host/transfer/uncertainty.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "host/cloud/uncertainty/radius.hpp"
#include "host/geometry/symmetric.hpp"
#include "host/transfer/align/icp.hpp"

namespace biteline::transfer {
namespace {

constexpr double k_share = 0.95;
constexpr double k_share_sigmas = 1.959964;  // of a normal distribution, both sides
constexpr int k_halvings = 24;               // of an interval some mm wide: below a micrometre

/// Beyond nine nothing is left that a double could hold beside 1.
double chance_below(double sigmas) {
  if (std::abs(sigmas) > 9) return sigmas < 0 ? 0 : 1;
  return 0.5 * std::erfc(-sigmas / std::numbers::sqrt2);
}

/// Below e^-60 a density adds nothing, and would underflow.
double bell(double sigmas) {
  return std::exp(std::max(-60.0, -0.5 * sigmas * sigmas));
}

/// The smallest value at which the rising `share_within` reaches the share, below `highest`.
template <class ShareWithin>
double reached_at(double highest, ShareWithin&& share_within) {
  double low = 0, high = highest;
  for (int i = 0; i < k_halvings; ++i) {
    const double middle = (low + high) / 2;
    (share_within(middle) < k_share ? low : high) = middle;
  }
  return high;
}

struct Spread {
  double weight, mean_mm, sigma_mm;
};

/// What lies within a distance, and how fast that grows.
struct Within {
  double share, per_mm;
};

Within share_within(const std::vector<Spread>& parts, double within_mm) {
  constexpr double k_density = std::numbers::inv_sqrtpi / std::numbers::sqrt2;
  Within sum{.share = 0, .per_mm = 0};
  for (const Spread& part : parts) {
    const double above = (within_mm - part.mean_mm) / part.sigma_mm,
                 below = (-within_mm - part.mean_mm) / part.sigma_mm;
    sum.share += part.weight * (chance_below(above) - chance_below(below));
    sum.per_mm += part.weight * k_density / part.sigma_mm * (bell(above) + bell(below));
  }
  return sum;
}

/// Newton's steps from what one normal distribution as wide would have; halved where a step leaves what is
/// still open.
double u95_mm(const std::vector<Spread>& parts) {
  constexpr double k_near_mm = 2e-5;  // the step after it is shorter than its square over the narrowest part
  double low = 0, high = 0, variance = 0;
  for (const Spread& part : parts) {
    high = std::max(high, std::abs(part.mean_mm) + 2 * k_share_sigmas * part.sigma_mm);
    variance += part.weight * (part.mean_mm * part.mean_mm + part.sigma_mm * part.sigma_mm);
  }
  double at = std::min(high, k_share_sigmas * std::sqrt(variance));
  for (int i = 0; i < 2 * k_halvings; ++i) {
    const Within within = share_within(parts, at);
    (within.share < k_share ? low : high) = at;
    const double next = within.per_mm > 0 ? at + (k_share - within.share) / within.per_mm : low;
    if (!(next > low && next < high)) {
      at = (low + high) / 2;
      continue;
    }
    if (std::abs(next - at) < k_near_mm) return next;
    at = next;
  }
  return at;
}

/// How the carried line moves with the placement: along the wall and across the line, target's frame.
Vec3 sight(const Vec3& normal, const Vec3& along, const Vec3& ray) {
  const Vec3 across = normal.cross(along).normalized();
  const double facing = std::max(k_min_facing_cosine, std::abs(normal.dot(ray)));
  return across - across.dot(ray) / std::copysign(facing, normal.dot(ray)) * normal;
}

}  // namespace

void tell_spread(const Belief& belief, const SE3& T_target_source, const CarryOptions& options,
                 std::vector<PlacedPoint>& placed) {
  const std::size_t size = placed.size();
  const SE3 T_source_target = T_target_source.inverse();
  const Mat3 R_source_target = T_source_target.linear();
  tbb::parallel_for(std::size_t{0}, size, [&](std::size_t i) {
    PlacedPoint& point = placed[i];
    const Vec3 along =
        (placed[(i + 1) % size].position - placed[(i + size - 1) % size].position).normalized();
    const Vec3 c = R_source_target * sight(point.normal, along, ray_direction(point, options));
    MotionRow row;
    row << c, (T_source_target * point.position).cross(c);
    std::vector<Spread> parts;
    for (const BeliefPart& part : belief) {
      parts.push_back({.weight = part.weight,
                       .mean_mm = row.dot(part.mean),
                       .sigma_mm = std::max(1e-6, std::sqrt(std::max(0.0, row.dot(part.covariance * row))))});
    }
    point.sigma_mm = u95_mm(parts) / k_share_sigmas;
  });
}

void tell_graded_spread(const Alignment& alignment, std::span<const Alignment::OnLine> on_sample,
                        const CarryOptions& options, std::vector<PlacedPoint>& placed) {
  const std::size_t size = placed.size();
  const Information covariance = geometry::SymmetricSolver{alignment.information}.inverse();
  const Mat3 R_source_target = alignment.placement.T_target_source.linear().transpose();
  tbb::parallel_for(std::size_t{0}, size, [&](std::size_t i) {
    PlacedPoint& point = placed[i];
    const Vec3 along =
        (placed[(i + 1) % size].position - placed[(i + size - 1) % size].position).normalized();
    const Vec3 c = R_source_target * sight(point.normal, along, ray_direction(point, options));
    const Alignment::OnLine used = alignment.as_used(on_sample[i]);
    const LineJacobian J = line_jacobian(alignment.placement.grade, used.point,
                                         used.normal.head<2>().normalized(), covariance.rows());
    const ParameterStep row = J.transpose() * c;
    point.sigma_mm = std::hypot(std::sqrt(std::max(0.0, row.dot(covariance * row))), alignment.rim_doubt_mm);
  });
}

void add_scan(const uncertainty::WholeScan& scan, const Vec3& up, cloud::ClosedLine& line) {
  if (!scan.known()) return;
  const uncertainty::SpreadAlong spread{scan, line.points.size(),
                                        [&](std::size_t i) { return line.points[i].position; }};
  for (std::size_t i = 0; i < line.points.size(); ++i) {
    cloud::LinePoint& point = line.points[i];
    const uncertainty::Axes axes =
        uncertainty::principal_axes(uncertainty::across(spread.at(i), point.tangent, up));
    point.confidence *= uncertainty::chance_within(axes, cloud::k_right_mm);
    point.u95_mm = std::hypot(*point.u95_mm, uncertainty::u95_mm(axes, 1, 0));
    cloud::flag_unsure(point);
  }
}

double bound_mm(const std::vector<double>& sigmas_mm) {
  if (sigmas_mm.empty()) return 0;
  const double largest = *std::max_element(sigmas_mm.begin(), sigmas_mm.end());
  return reached_at(2 * k_share_sigmas * largest, [&](double within_mm) {
    double share = 0;
    for (const double sigma_mm : sigmas_mm)
      share += std::erf(within_mm / (std::numbers::sqrt2 * std::max(1e-6, sigma_mm)));
    return share / static_cast<double>(sigmas_mm.size());
  });
}

}  // namespace biteline::transfer
