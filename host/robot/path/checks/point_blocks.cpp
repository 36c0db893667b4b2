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

/// A capsule's axis, asked for its distance to many points.
class Axis {
 public:
  explicit Axis(const Capsule& capsule) : begin_{capsule.a}, along_{capsule.b - capsule.a} {
    const double length2 = along_.squaredNorm();
    per_length2_ = length2 > 0 ? 1 / length2 : 0;
  }
  [[nodiscard]] double squared_to(const Vec3& point) const {
    const Vec3 from_begin = point - begin_;
    const double t = std::clamp(from_begin.dot(along_) * per_length2_, 0.0, 1.0);
    return (from_begin - t * along_).squaredNorm();
  }

 private:
  Vec3 begin_, along_;
  double per_length2_;
};

double squared(double value) {
  return value * value;
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
  const Axis axis{capsule};
  // From the axis: of what is nearest so far.
  double least_mm = enough_mm + capsule.radius_mm;
  if (!(least_mm > 0)) return enough_mm;
  bool any = false;
  for (const Block& block : blocks_) {
    if (!(axis.squared_to(block.centre) < squared(least_mm + block.radius_mm))) continue;
    double least2 = squared(least_mm);
    for (std::size_t i = block.first; i < block.end; ++i)
      least2 = std::min(least2, axis.squared_to(points_[i]));
    if (!(least2 < squared(least_mm))) continue;
    least_mm = std::sqrt(least2);
    any = true;
  }
  return any ? least_mm - capsule.radius_mm : enough_mm;
}

}  // namespace biteline::path
