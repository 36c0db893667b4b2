// SPDX-License-Identifier: MIT
#include "tests/support/made_session.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>
#include <random>
#include <string>

#include "common/config/sensor_yaml.hpp"
#include "common/image/grey_image.hpp"

namespace biteline::test {
namespace {

constexpr std::int64_t k_first_ns = 1'700'000'000'000'000'000;
constexpr std::int64_t k_frame_period_ns = 10'000'000;
constexpr std::int64_t k_pose_period_ns = 2'000'000;
constexpr std::int64_t k_lead_ns = 50'000'000;  // poses before the first and after the last frame

/// Straight on at 100 mm/s with a slow turn.
SE3 pose_at(double time_s) {
  const Eigen::Quaterniond turn{Eigen::AngleAxisd{0.3 + 0.2 * time_s, Vec3{0.2, 0.5, 0.8}.normalized()}};
  return geometry::make_se3(turn, {400 + 100 * time_s, -120 + 15 * time_s, 300});
}

image::GreyImage draw(const MadeSession& made, int frame, std::mt19937& random) {
  // A stripe of 2.5 px standard deviation: wide enough that pixel sampling costs no accuracy.
  constexpr double k_amplitude = 180;
  constexpr double k_sigma_px = 2.5;
  constexpr double k_background = 8;
  std::normal_distribution<double> noise{0, 1.5};
  image::GreyImage picture{.width_px = made.width_px, .height_px = made.height_px, .pixels = {}};
  for (int row = 0; row < made.height_px; ++row) {
    for (int column = 0; column < made.width_px; ++column) {
      const double distance = (row - made_row_px(made, frame, column)) / k_sigma_px;
      // Beyond 8 sigma nothing is left, and exp() would underflow.
      const double light = std::abs(distance) < 8 ? k_amplitude * std::exp(-0.5 * distance * distance) : 0;
      const double grey = std::clamp(k_background + light + noise(random), 0.0, 255.0);
      picture.pixels.push_back(static_cast<std::uint8_t>(std::lround(grey)));
    }
  }
  return picture;
}

}  // namespace

double made_row_px(const MadeSession& made, int frame, int column) {
  const double phase = 2 * std::numbers::pi * (column / 80.0 + frame / 15.0);
  return 0.5 * made.height_px + 0.15 * made.height_px * std::sin(phase);
}

geometry::SensorModel made_sensor(const MadeSession& made) {
  geometry::SensorModel sensor;
  sensor.camera = {.fu_px = 900,
                   .fv_px = 890,
                   .cu_px = 100,
                   .cv_px = 130,
                   .k1 = -0.1,
                   .k2 = 0.05,
                   .p1 = 0.0004,
                   .p2 = -0.0003};
  sensor.laser_plane = {.normal_cam = Vec3{0.01, 0.7, -0.71}.normalized(), .distance_mm = -142};
  sensor.T_flange_cam = geometry::make_se3(
      Eigen::Quaterniond{Eigen::AngleAxisd{0.8, Vec3{0.9, -0.3, 0.2}.normalized()}}, {9, 150, 250});
  sensor.region = {
      .offset_u_px = 20, .offset_v_px = 80, .width_px = made.width_px, .height_px = made.height_px};
  sensor.rate_hz = 100;
  sensor.exposure = Nanoseconds{400'000};
  sensor.pose_clock_offset = Nanoseconds{7'000'000};
  return sensor;
}

SE3 made_pose(int frame) {
  return pose_at(static_cast<double>(frame * k_frame_period_ns) * 1e-9);
}

void write_made_session(const MadeSession& made, const std::filesystem::path& folder) {
  namespace fs = std::filesystem;
  fs::create_directories(folder / "cam0" / "data");
  fs::create_directories(folder / "pose0");
  const geometry::SensorModel sensor = made_sensor(made);
  std::ofstream{folder / "cam0" / "sensor.yaml"} << config::sensor_yaml_text(sensor, "made for a test");
  std::mt19937 random{made.seed};
  std::vector<session::FrameEntry> frames;
  for (int frame = 0; frame < made.frames; ++frame) {
    const std::int64_t stamp_ns = k_first_ns + frame * k_frame_period_ns;
    const fs::path file = folder / "cam0" / "data" / (std::to_string(stamp_ns) + ".png");
    (void)image::write_png(file, draw(made, frame, random));
    frames.push_back({.exposure_mid = SensorClock::time_point{Nanoseconds{stamp_ns}}, .file = file});
  }
  std::vector<session::StampedPose> poses;
  const std::int64_t last_ns = (made.frames - 1) * k_frame_period_ns + k_lead_ns;
  for (std::int64_t time_ns = -k_lead_ns; time_ns <= last_ns; time_ns += k_pose_period_ns) {
    poses.push_back(
        {.stamp = RobotClock::time_point{Nanoseconds{k_first_ns + time_ns} + sensor.pose_clock_offset},
         .T_base_flange = pose_at(static_cast<double>(time_ns) * 1e-9)});
  }
  (void)session::write_frame_table(folder / "cam0" / "data.csv", frames);
  (void)session::write_pose_table(folder / "pose0" / "data.csv", poses);
}

}  // namespace biteline::test
