// SPDX-License-Identifier: MIT
#include "host/robot/path/checks/point_blocks.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <tuple>

namespace biteline::path {
namespace {

using kinematics::Capsule;

/// Some dozen points of a shoe's surface.
constexpr double k_cube_mm = 32;
constexpr double k_far_away_mm = 1e9;

double to_point_mm(const Capsule& capsule, const Vec3& point) {
  const Vec3 along = capsule.b - capsule.a;
  const double length2 = along.squaredNorm();
  const double t = length2 > 0 ? std::clamp((point - capsule.a).dot(along) / length2, 0.0, 1.0) : 0.0;
  return (point - capsule.a - t * along).norm() - capsule.radius_mm;
}

auto cube_of(const Vec3& point) {
  const auto cell = [](double mm) { return static_cast<long>(std::floor(mm / k_cube_mm)); };
  return std::tuple{cell(point.x()), cell(point.y()), cell(point.z())};
}

}  // namespace

PointBlocks::PointBlocks(const std::vector<Vec3>& points) {
  // Of other numbers nobody can say where they are.
  std::ranges::copy_if(points, std::back_inserter(points_), [](const Vec3& p) {
    return p.allFinite() && p.cwiseAbs().maxCoeff() < k_far_away_mm;
  });
  std::ranges::sort(points_, {}, cube_of);
  for (std::size_t first = 0, end = 0; first < points_.size(); first = end) {
    Eigen::AlignedBox3d box;
    for (end = first; end < points_.size() && cube_of(points_[end]) == cube_of(points_[first]); ++end)
      box.extend(points_[end]);
    double radius_mm = 0;
    for (std::size_t i = first; i < end; ++i)
      radius_mm = std::max(radius_mm, (points_[i] - box.center()).norm());
    blocks_.push_back({.centre = box.center(), .radius_mm = radius_mm, .first = first, .end = end});
  }
}

double PointBlocks::nearest_mm(const Capsule& capsule, double enough_mm) const {
  double nearest_mm = enough_mm;
  for (const Block& block : blocks_) {
    if (!(to_point_mm(capsule, block.centre) - block.radius_mm < nearest_mm)) continue;
    for (std::size_t i = block.first; i < block.end; ++i)
      nearest_mm = std::min(nearest_mm, to_point_mm(capsule, points_[i]));
  }
  return nearest_mm;
}

}  // namespace biteline::path
