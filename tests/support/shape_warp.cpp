// SPDX-License-Identifier: MIT
#include "tests/support/shape_warp.hpp"

#include <cmath>
#include <numbers>
#include <random>

namespace biteline::test {

namespace {
constexpr double k_turn_rad = 2 * std::numbers::pi;
}

ShapeWarp ShapeWarp::drawn(std::uint32_t seed) {
  std::mt19937 random{seed};
  const auto between = [&](double low, double high) {
    return std::uniform_real_distribution<double>{low, high}(random);
  };
  ShapeWarp warp{.seed = seed};
  warp.scale = {between(0.85, 1.15), between(0.85, 1.15), between(0.8, 1.2)};
  warp.spring_mm = between(0, 5);
  warp.spring_phase_rad = between(0, k_turn_rad);
  warp.curve_mm = between(0, 5);
  warp.curve_phase_rad = between(0, k_turn_rad);
  warp.wave_mm = between(200, 500);
  warp.yaw_rad = between(0, k_turn_rad);
  warp.tilt_rad = between(0, 0.08);
  warp.tilt_to_rad = between(0, k_turn_rad);
  warp.mirrored = between(0, 1) < 0.5;
  warp.noise_mm = between(0, 0.05);
  warp.kept_share = between(0.5, 1);
  constexpr double k_with_gap = 0.3;
  if (between(0, 1) < k_with_gap) {
    warp.sector_rad = between(0.05, 0.25);
    warp.sector_at_rad = between(0, k_turn_rad);
  }
  return warp;
}

ShapeWarp ShapeWarp::rigid() const {
  return {.yaw_rad = yaw_rad, .tilt_rad = tilt_rad, .tilt_to_rad = tilt_to_rad, .mirrored = mirrored};
}

Vec3 ShapeWarp::place(const Vec3& at) const {
  const double along = k_turn_rad * at.x() / wave_mm;
  Vec3 to = scale.cwiseProduct(at);
  to.y() += curve_mm * std::sin(along + curve_phase_rad);
  to.z() += spring_mm * std::sin(along + spring_phase_rad);
  if (mirrored) to.y() = -to.y();
  const Vec3 axis{std::cos(tilt_to_rad), std::sin(tilt_to_rad), 0};
  return Eigen::AngleAxisd{yaw_rad, Vec3::UnitZ()} * (Eigen::AngleAxisd{tilt_rad, axis} * to);
}

cloud::PointCloud ShapeWarp::cloud(const cloud::PointCloud& of) const {
  Vec3 middle = Vec3::Zero();
  for (const Eigen::Vector3f& p : of.points)
    middle += p.cast<double>() / static_cast<double>(of.points.size());
  std::mt19937 random{seed};
  std::normal_distribution<double> noise{0, noise_mm > 0 ? noise_mm : 1};
  std::bernoulli_distribution kept{kept_share};
  cloud::PointCloud to;
  for (std::size_t i = 0; i < of.points.size(); ++i) {
    const Vec3 at = of.points[i].cast<double>();
    const double from = std::atan2(at.y() - middle.y(), at.x() - middle.x()) - sector_at_rad;
    const bool hidden = from - k_turn_rad * std::floor(from / k_turn_rad) < sector_rad;
    if (hidden || (kept_share < 1 && !kept(random))) continue;
    Vec3 moved = place(at);
    if (noise_mm > 0) moved += Vec3{noise(random), noise(random), noise(random)};
    to.points.push_back(moved.cast<float>());
    if (!mirrored && !of.profile.empty()) to.profile.push_back(of.profile[i]);
    if (!mirrored && !of.column.empty()) to.column.push_back(of.column[i]);
  }
  return to;
}

cloud::ClosedLine ShapeWarp::line(cloud::ClosedLine of) const {
  for (cloud::LinePoint& p : of.points) p.position = place(p.position);
  return of;
}

}  // namespace biteline::test
