// SPDX-License-Identifier: MIT
#include "host/bite_line/evaluation/line_error.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "host/bite_line/evaluation/statistics.hpp"

namespace biteline::evaluation {
namespace {

using Points = std::vector<Vec3>;

Points positions(const cloud::ClosedLine& line) {
  Points points;
  for (const auto& p : line.points) points.push_back(p.position);
  return points;
}

struct NearestPlace {
  Vec3 point;
  double distance_mm;
};

/// Nearest point of the closed polyline.  Brute force: a thousand by a thousand segments take milliseconds.
NearestPlace foot_on(const Points& polyline, const Vec3& p) {
  NearestPlace best{.point = polyline.front(), .distance_mm = std::numeric_limits<double>::max()};
  for (std::size_t i = 0; i < polyline.size(); ++i) {
    const Vec3& a = polyline[i];
    const Vec3 ab = polyline[(i + 1) % polyline.size()] - a;
    const double length2 = ab.squaredNorm();
    const double s = length2 > 0 ? std::clamp(ab.dot(p - a) / length2, 0.0, 1.0) : 0.0;
    const Vec3 q = a + s * ab;
    const double distance_mm = (p - q).norm();
    if (distance_mm < best.distance_mm) best = {.point = q, .distance_mm = distance_mm};
  }
  return best;
}

LineError error_between(const Points& result, const Points& truth) {
  constexpr double k_complete_within_mm = 1.0;
  std::vector<double> distances_mm;
  double length_mm = 0, found_mm = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const double distance_mm = foot_on(result, truth[i]).distance_mm;
    distances_mm.push_back(distance_mm);
    // A true point stands for half of the segments on both sides.
    const double share_mm = 0.5 * ((truth[(i + 1) % truth.size()] - truth[i]).norm() +
                                   (truth[i] - truth[(i + truth.size() - 1) % truth.size()]).norm());
    length_mm += share_mm;
    if (distance_mm <= k_complete_within_mm) found_mm += share_mm;
  }
  for (const Vec3& p : result) distances_mm.push_back(foot_on(truth, p).distance_mm);
  std::sort(distances_mm.begin(), distances_mm.end());
  LineError error;
  for (const double d_mm : distances_mm) error.mean_mm += d_mm / static_cast<double>(distances_mm.size());
  error.p95_mm = quantile(distances_mm, 0.95);
  error.max_mm = distances_mm.back();
  error.complete = length_mm > 0 ? found_mm / length_mm : 0;
  return error;
}

}  // namespace

LineError line_error(const cloud::ClosedLine& result, const cloud::ClosedLine& truth) {
  return error_between(positions(result), positions(truth));
}

LineError line_error_aligned(const cloud::ClosedLine& result, const cloud::ClosedLine& truth) {
  const Points goal = positions(truth);
  Points moved = positions(result);
  SE3 T_truth_line = SE3::Identity();
  constexpr int k_most_rounds = 100;
  for (int round = 0; round < k_most_rounds; ++round) {
    Eigen::Matrix3Xd from(3, moved.size()), to(3, moved.size());
    for (std::size_t i = 0; i < moved.size(); ++i) {
      from.col(static_cast<Eigen::Index>(i)) = moved[i];
      to.col(static_cast<Eigen::Index>(i)) = foot_on(goal, moved[i]).point;
    }
    SE3 T_step;
    T_step.matrix() = Eigen::umeyama(from, to, false);
    T_truth_line = geometry::orthonormalised(T_step * T_truth_line);
    double largest_mm = 0;
    for (Vec3& p : moved) {
      const Vec3 q = T_step * p;
      largest_mm = std::max(largest_mm, (q - p).norm());
      p = q;
    }
    if (largest_mm < 1e-6) break;
  }
  LineError error = error_between(moved, goal);
  error.T_truth_line = T_truth_line;
  return error;
}

std::optional<double> normal_error_deg(const cloud::ClosedLine& result, const ReferenceSurface& surface,
                                       const Vec3& up) {
  constexpr double k_from_mm = 2.0, k_to_mm = 6.0, k_step_mm = 0.2;
  // From this far outside a level ray meets the shoe's outer surface first and nothing else of the shoe.
  constexpr double k_outside_mm = 12.0;
  double squares = 0;
  std::size_t measured = 0;
  const std::size_t n = result.points.size();
  for (std::size_t i = 0; i < n; ++i) {
    const auto& point = result.points[i];
    // The outline's direction over a few millimetres, so that noise of single points does not turn the
    // section.
    const std::size_t reach = std::max<std::size_t>(1, n / 300);
    Vec3 along = result.points[(i + reach) % n].position - result.points[(i + n - reach) % n].position;
    along -= up * up.dot(along);
    if (along.norm() < 1e-9) continue;
    const Vec3 out = along.cross(up).normalized();
    Vec3 sum = Vec3::Zero();
    for (double h_mm = k_from_mm; h_mm <= k_to_mm + 1e-9; h_mm += k_step_mm) {
      const auto hit = surface.first_hit({.origin = point.position + h_mm * up + k_outside_mm * out,
                                          .direction = -out,
                                          .length_mm = 2 * k_outside_mm});
      if (hit) sum += hit->normal.dot(out) >= 0 ? hit->normal : Vec3(-hit->normal);
    }
    if (sum.norm() < 1e-9 || point.normal.norm() < 0.5) continue;
    const double angle_rad = std::acos(std::clamp(sum.normalized().dot(point.normal), -1.0, 1.0));
    squares += angle_rad * angle_rad;
    ++measured;
  }
  if (measured * 2 < n) return std::nullopt;
  return std::sqrt(squares / static_cast<double>(measured)) * 180.0 / std::numbers::pi;
}

}  // namespace biteline::evaluation
