// SPDX-License-Identifier: MIT
#pragma once
/// \file A ball of 80 mm radius that a head passes twice, the second time turned: all of it by formula.

#include <random>
#include <vector>

#include "host/calibration/drift/evidence.hpp"

namespace biteline::drift {

struct BallScan {
  std::vector<Eigen::Vector3f> points_base;
  std::vector<std::uint32_t> profile;
  std::vector<PosedProfile> poses;
  [[nodiscard]] ScanView view() const { return {points_base, profile, poses}; }
};

inline geometry::SensorModel ball_head() {
  geometry::SensorModel head;
  head.camera = {.fu_px = 2700,
                 .fv_px = 2700,
                 .cu_px = 800,
                 .cv_px = 600,
                 .k1 = -0.1,
                 .k2 = 0.1,
                 .p1 = 0,
                 .p2 = 0,
                 .k3 = 0};
  head.laser_plane.normal_cam = Vec3{0, 1, -1}.normalized();
  head.laser_plane.distance_mm = head.laser_plane.normal_cam.dot(Vec3{0, 0, 200});
  head.region = {.offset_u_px = 0, .offset_v_px = 0, .width_px = 1600, .height_px = 1200};
  head.T_flange_cam = geometry::exp_se3((Twist{} << 40, -30, 90, 0.2, -0.1, 0.3).finished());
  return head;
}

struct BallDraw {
  Vector drifted{Vector::Zero()};
  std::uint64_t seed{1};
  double turned_rad{0.25};  ///< the second pass against the first, about all three axes, more and less
  double noise_mm{0.005};   ///< along the ray
  double pose_mm{0.004};    ///< of each pose
};

/// What the head, as it has drifted, makes of the ball while its user believes in ball_head().
inline BallScan scan_ball(const BallDraw& draw) {
  constexpr double k_radius_mm = 80, k_step_mm = 1.5, k_frame_s = 0.01;
  constexpr int k_frames = 24;
  std::mt19937_64 random(draw.seed);
  std::normal_distribution<double> normal;
  const geometry::SensorModel told = ball_head();
  const uncertainty::Parameters drifted = parameters_of(draw.drifted);
  const geometry::SensorModel actual = uncertainty::perturbed(told, axes_of(told), drifted);
  const double late_s = drifted[uncertainty::k_clock_at];
  const Vec3 centre{500, 50, 100};
  // The camera looks at the ball's near side from 200 mm, and goes round it along its own y.
  const auto T_base_cam = [&](int pass, double k) -> SE3 {
    const double u = k / k_frames, swing = pass == 0 ? 0 : draw.turned_rad;
    Mat3 R =
        geometry::exp_so3(Vec3{0.02 * u, 0, 0}) * geometry::exp_so3(Vec3{swing, swing * (1 - u), swing * u});
    const double near_mm = pass == 0 ? 0 : 20 * (u - 0.5);
    SE3 T = SE3::Identity();
    T.linear() = R;
    T.translation() = centre - Vec3{0, 0, k_radius_mm} + Vec3{0, k_step_mm * (k - k_frames / 2.0), 0} -
                      R * Vec3{0, 0, 200 + near_mm};
    return T;
  };
  BallScan made;
  for (std::uint32_t f = 0; f < 2 * k_frames; ++f) {
    const int pass = f < k_frames ? 0 : 1;
    const double k = f - pass * k_frames, time_s = k_frame_s * f + pass;
    const SE3 flange = T_base_cam(pass, k) * told.T_flange_cam.inverse();
    SE3 said = T_base_cam(pass, k - late_s / k_frame_s) * told.T_flange_cam.inverse();
    said.translation() += draw.pose_mm * Vec3{normal(random), normal(random), normal(random)};
    made.poses.push_back({.profile = 10 + f, .pose = {.T_base_flange = said, .time_s = time_s}});
    // The arm came to the second pass's begin some other way: no speed there that a pose before would tell.
    if (f % k_frames == 0 || f % k_frames == k_frames - 1) continue;
    const SE3 T = flange * actual.T_flange_cam;
    const Vec3 c = T.inverse() * centre, n = actual.laser_plane.normal_cam;
    const double off_mm = actual.laser_plane.signed_distance_mm(c);
    const Vec3 middle = c - off_mm * n, e1 = Vec3::UnitX() - n.x() * n, e2 = n.cross(e1.normalized());
    const double r = std::sqrt(k_radius_mm * k_radius_mm - off_mm * off_mm);
    const double side = e2.z() > 0 ? -1 : 1;  // towards the camera
    for (int i = -50; i <= 50; ++i) {
      const double a = 0.5 * i / r;
      const Vec3 point = middle + r * (std::sin(a) * e1.normalized() + side * std::cos(a) * e2);
      const Vec3 seen = geometry::triangulate(told.camera, told.laser_plane, actual.camera.project(point));
      const Vec3 noisy = seen + draw.noise_mm * normal(random) * seen.normalized();
      made.points_base.push_back((said * told.T_flange_cam * noisy).cast<float>());
      made.profile.push_back(10 + f);
    }
  }
  return made;
}

}  // namespace biteline::drift
