// SPDX-License-Identifier: MIT
#include "hal/sim/render/made_head.hpp"

#include <cmath>
#include <numbers>

#include "hal/sim/shoe/random.hpp"

namespace biteline::sim {

namespace {

constexpr double k_degree = std::numbers::pi / 180;

SE3 small_motion(Random& random, double translation_mm, double rotation_rad) {
  Twist xi;
  for (int i = 0; i < 3; ++i) {
    xi[i] = translation_mm * random.gaussian();
    xi[i + 3] = rotation_rad * random.gaussian();
  }
  return geometry::exp_se3(xi);
}

/// The camera of a head on its bracket.  The flange hangs above the working point, some way inwards of it.
SE3 T_flange_cam_on_bracket(const Vec3& beam_cam, const Vec3& working_point_cam) {
  constexpr double k_above_mm = 250, k_inwards_mm = 60;
  // x and z span the upright plane of the beam.
  SE3 T_cam_beam = SE3::Identity();
  T_cam_beam.linear() << Vec3::UnitX(), beam_cam.cross(Vec3::UnitX()), beam_cam;
  T_cam_beam.translation() = working_point_cam;
  const double c = std::cos(k_bracket_pitch_rad), s = std::sin(k_bracket_pitch_rad);
  const Vec3 up(c, 0, -s), inwards(s, 0, c);
  SE3 T_beam_flange = SE3::Identity();
  T_beam_flange.linear() << inwards, (-up).cross(inwards), -up;
  T_beam_flange.translation() = k_above_mm * up + k_inwards_mm * inwards;
  return (T_cam_beam * T_beam_flange).inverse(Eigen::Isometry);
}

}  // namespace

void set_light(MadeHead& head, const HeadLight& light) {
  head.optics.f_number = light.f_number;
  head.optics.wavelength_nm = light.wavelength_nm;
  head.laser.line_width_nm = light.line_width_nm;
  head.laser.coherent = light.coherent;
}

MadeHead draw_head(std::uint64_t seed, Holder holder) {
  Random random(seed ^ 0x48454144ULL);
  MadeHead head;
  const double focal_px = 2720 * (1 + 0.01 * random.gaussian());
  head.model.camera = {.fu_px = focal_px * (1 + 0.002 * random.gaussian()),
                       .fv_px = focal_px * (1 + 0.002 * random.gaussian()),
                       .cu_px = 812.5 + 8 * random.gaussian(),
                       .cv_px = 617.5 + 8 * random.gaussian(),
                       .k1 = random.uniform({-0.14, -0.07}),
                       .k2 = random.uniform({0.06, 0.18}),
                       .p1 = random.uniform({-4e-4, 4e-4}),
                       .p2 = random.uniform({-4e-4, 4e-4}),
                       .k3 = 0};

  // Plane through the working point, at 45 degrees to the axis, along the picture's rows; then turned a
  // little.
  head.working_distance_mm = 200 + 2 * random.gaussian();
  const double angle_rad = 45 * k_degree + 0.006 * random.gaussian();
  const Vec3 working_point{0, 0, head.working_distance_mm};
  const Mat3 R_tilt = geometry::exp_so3(Vec3(0, 0.002 * random.gaussian(), 0.002 * random.gaussian()));
  const Vec3 normal_cam = R_tilt * Vec3(0, std::sin(angle_rad), -std::cos(angle_rad));
  const Vec3 beam_cam = R_tilt * Vec3(0, std::cos(angle_rad), std::sin(angle_rad));
  head.model.laser_plane = {.normal_cam = normal_cam, .distance_mm = normal_cam.dot(working_point)};
  constexpr double k_focal_mm = 12;
  head.optics.magnification = k_focal_mm / (head.working_distance_mm - k_focal_mm);
  constexpr double k_emitter_distance_mm = 190;
  head.laser.beam_cam = beam_cam;
  head.laser.emitter_cam = working_point - k_emitter_distance_mm * beam_cam;

  // The beam leaves along the flange's z, as the holder carries the laser plane at right angles to its plate.
  constexpr double k_flange_to_working_point_mm = 394;
  const Mat3 R_flange_cam = geometry::exp_so3(Vec3(45 * k_degree, 0, 0));
  const Vec3 camera_flange = Vec3(0, 0, k_flange_to_working_point_mm) - R_flange_cam * working_point;
  const Vec3 nominal_beam_cam = R_flange_cam.transpose() * Vec3::UnitZ();
  const SE3 T_flange_cam = holder == Holder::Bracket
                               ? T_flange_cam_on_bracket(nominal_beam_cam, working_point)
                               : geometry::make_se3(Eigen::Quaterniond(R_flange_cam), camera_flange);
  head.model.T_flange_cam = T_flange_cam * small_motion(random, 1.5, 0.008);

  constexpr int k_region_height_px = 320;
  head.model.region = {
      .offset_u_px = 0,
      .offset_v_px =
          4 * static_cast<int>(std::lround((head.model.camera.cv_px - k_region_height_px / 2.0) / 4)),
      .width_px = head.sensor_width_px,
      .height_px = k_region_height_px};
  head.model.rate_hz = 100;
  head.model.exposure = Nanoseconds{400'000};
  return head;
}

}  // namespace biteline::sim
