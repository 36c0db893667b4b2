// SPDX-License-Identifier: MIT
#pragma once
/// \file A table that a head passes all the way round: all of it by formula.

#include <numbers>
#include <random>

#include "tests/unit/host/calibration/drift/seen_ball.hpp"

namespace biteline::drift {

struct TableDraw {
  Vector drifted{Vector::Zero()};  ///< of the head, and of the table
  double round_mm{120};            ///< radius of the way that the head goes
  double noise_mm{0.005};
  std::uint64_t seed{5};
};

/// What a head that goes round makes of a table, from its own side each time; by formula.
inline BallScan scan_table(const TableDraw& draw) {
  constexpr int k_frames = 180;
  std::mt19937_64 random(draw.seed);
  std::normal_distribution<double> normal;
  const geometry::SensorModel told = ball_head();
  const geometry::SensorModel actual =
      uncertainty::perturbed(told, axes_of(told), parameters_of(draw.drifted));
  const Vec3 middle{600, 40, 80};
  const Vec3 tilt{k_table[14].si * draw.drifted[14], k_table[15].si * draw.drifted[15], -1};
  const Vec3 table_normal = -tilt.normalized();
  const Vec3 table_at = middle + Vec3{0, 0, 0.1 * draw.drifted[k_table_at]};
  BallScan made;
  for (std::uint32_t k = 0; k < k_frames; ++k) {
    const double turn_rad = 2 * std::numbers::pi * k / k_frames;
    // Steeply down, somewhat outwards, and not always the same.
    const double lean_rad = 0.5 + 0.1 * std::sin(3 * turn_rad);
    SE3 T_base_cam = SE3::Identity();
    T_base_cam.linear() = (Eigen::AngleAxisd(turn_rad, Vec3::UnitZ()) *
                           Eigen::AngleAxisd(std::numbers::pi - lean_rad, Vec3::UnitY()))
                              .toRotationMatrix();
    T_base_cam.translation() = middle + draw.round_mm * Vec3{std::cos(turn_rad), std::sin(turn_rad), 0} -
                               T_base_cam.linear() * Vec3{0, 0, 200};
    const SE3 said = T_base_cam * told.T_flange_cam.inverse();
    made.poses.push_back({.profile = k, .pose = {.T_base_flange = said, .time_s = 0.01 * k}});
    const SE3 T_base_seen = said * actual.T_flange_cam;
    const Vec3 n = T_base_seen.linear().transpose() * table_normal;
    const Vec3 p = T_base_seen.inverse() * table_at;
    const Vec3& l = actual.laser_plane.normal_cam;
    const Vec3 along = l.cross(n).normalized();
    Mat3 meets;
    meets << l.transpose(), n.transpose(), along.transpose();
    const Vec3 foot = meets.inverse() * Vec3{actual.laser_plane.distance_mm, n.dot(p), along.dot(p)};
    for (int i = -10; i <= 10; ++i) {
      const Vec3 point = foot + 0.6 * i * along;
      const Vec3 seen = geometry::triangulate(told.camera, told.laser_plane, actual.camera.project(point));
      const Vec3 noisy = seen + draw.noise_mm * normal(random) * seen.normalized();
      made.points_base.push_back((said * told.T_flange_cam * noisy).cast<float>());
      made.profile.push_back(k);
    }
  }
  return made;
}

}  // namespace biteline::drift
