// SPDX-License-Identifier: MIT
// A made head's calibration pictures, part of the repository, against the head's true values.
#include <CppUTest/TestHarness.h>

#include <cmath>
#include <filesystem>

#include "common/config/sensor_yaml.hpp"
#include "host/calibration/head/head_calibration.hpp"
#include "tests/support/errors.hpp"

namespace biteline::calibration {
namespace {

// One of 16 000 normal errors is larger.  Fewer than twenty values are independent.
constexpr double k_sigmas = 4;

}  // namespace

TEST_GROUP(GoldenCalibration){};

TEST(GoldenCalibration, HeadIsTheTrueOneWithinWhatTheCalibrationSaysOfItself) {
  const std::filesystem::path folder{BITELINE_GOLDEN "/head"};
  HeadInput input;
  input.camera = *read_camera_folder(folder);
  input.laser = *read_laser_folder(folder);
  input.hand_eye = *read_hand_eye_folder(folder);
  const HeadCalibration sut = calibrate_head(input);
  CHECK_TEXT(!sut.refused, sut.refused ? to_line(*sut.refused).c_str() : "");
  LONGS_EQUAL(0, sut.set_aside.size());
  const auto truth = config::read_sensor_yaml(folder / "truth/sensor.yaml");
  SUCCEEDS(truth);

  const Twist mounting_sigma = sut.fit.mounting_sigma(),
              mounting_error = geometry::log_se3(truth->T_flange_cam.inverse() * sut.fit.state.T_flange_cam);
  for (int i = 0; i < 6; ++i) CHECK_COMPARE(std::abs(mounting_error[i]), <=, k_sigmas * mounting_sigma[i]);
  // Four stops with poses of 0.020 mm and 1e-4 rad, which are 0.03 mm at 300 mm.
  CHECK_COMPARE(mounting_sigma.head<3>().norm(), <=, 0.1);

  // A point anywhere in the working region, in the camera's own frame.
  for (int u = 100; u < 1600; u += 100) {
    for (int v = 470; v < 780; v += 50) {
      const Vec3 error_mm = geometry::triangulate(sut.fit.state.camera, sut.fit.state.plane, Vec2(u, v)) -
                            geometry::triangulate(truth->camera, truth->laser_plane, Vec2(u, v));
      const Vec3 sigma_mm = sut.fit.triangulation_sigma_mm(Vec2(u, v));
      for (int axis = 0; axis < 3; ++axis)
        CHECK_COMPARE(std::abs(error_mm[axis]), <=, k_sigmas * sigma_mm[axis]);
      CHECK_COMPARE(sigma_mm.norm(), <=, 0.05);
    }
  }
}

}  // namespace biteline::calibration
