// SPDX-License-Identifier: MIT
#include "host/apps/biteline-web/profile_curvature.hpp"

#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>

namespace biteline::web {
namespace {

using profile::ProfilePoint;

bool is_surface(const ProfilePoint& point) {
  return (point.flags & profile::k_point_not_surface) == 0;
}

/// The first point of the surface that is `reach_mm` away, in the direction of `step`; none beyond a gap.
std::optional<Eigen::Vector3f> neighbour(std::span<const ProfilePoint> points, std::size_t at,
                                         std::ptrdiff_t step, float reach_mm) {
  const Eigen::Vector3f& from = points[at].point_cam;
  for (auto i = static_cast<std::ptrdiff_t>(at) + step; i >= 0 && i < std::ssize(points); i += step) {
    const ProfilePoint& point = points[static_cast<std::size_t>(i)];
    if (!is_surface(point)) continue;
    const float away_mm = (point.point_cam - from).norm();
    if (away_mm > 2 * reach_mm) return std::nullopt;
    if (away_mm >= reach_mm) return point.point_cam;
  }
  return std::nullopt;
}

}  // namespace

std::vector<float> profile_curvature(std::span<const ProfilePoint> points, float reach_mm) {
  std::vector<float> curvature(points.size(), std::numeric_limits<float>::quiet_NaN());
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!is_surface(points[i])) continue;
    const std::optional<Eigen::Vector3f> before = neighbour(points, i, -1, reach_mm);
    const std::optional<Eigen::Vector3f> behind = neighbour(points, i, 1, reach_mm);
    if (!before || !behind) continue;
    const Eigen::Vector3f& here = points[i].point_cam;
    const Eigen::Vector3f a = here - *before, b = *behind - here, chord = *behind - *before;
    const float bent = 2 * a.cross(b).norm() / (a.norm() * b.norm() * chord.norm());
    // Away from the camera: a groove.
    const float depth_mm = here.z() - 0.5F * (before->z() + behind->z());
    curvature[i] = std::copysign(bent, depth_mm);
  }
  return curvature;
}

}  // namespace biteline::web
