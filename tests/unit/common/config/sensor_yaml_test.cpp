// SPDX-License-Identifier: MIT
#include "common/config/sensor_yaml.hpp"

#include <CppUTest/TestHarness.h>

#include <random>

#include "tests/support/errors.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/transforms.hpp"

namespace biteline::config {

TEST_GROUP(SensorYaml) {
  test::TemporaryFolder folder;
  geometry::SensorModel sensor{
      .camera = {.fu_px = 2730.5,
                 .fv_px = 2712.25,
                 .cu_px = 822,
                 .cv_px = 628,
                 .k1 = -0.11,
                 .k2 = 0.14,
                 .p1 = 3e-4,
                 .p2 = -2e-4,
                 .k3 = 0},
      .laser_plane = {.normal_cam = Vec3(0.01, 0.704, -0.71).normalized(), .distance_mm = -142.0625},
      .T_flange_cam = geometry::exp_se3((Twist() << 9, 153, 250, 0.8, 0.1, -0.02).finished()),
      .region = {.offset_u_px = 0, .offset_v_px = 460, .width_px = 1626, .height_px = 320},
      .pose_clock_offset = Nanoseconds{3'700'000},
      .rate_hz = 100.0,
      .exposure = Nanoseconds{400'000}};

  Result<geometry::SensorModel> read(const std::string& text) {
    return read_sensor_yaml(folder.write("sensor.yaml", text));
  }
  std::string changed(const std::string& from, const std::string& to) const {
    std::string text = sensor_yaml_text(sensor, "made");
    const auto at = text.find(from);
    CHECK(at != std::string::npos);
    return text.replace(at, from.size(), to);
  }
};

TEST(SensorYaml, TheCamerasStateIsABlockThatMayLack) {
  CHECK(sensor_yaml_text(sensor, "made").find("camera_state") == std::string::npos);
  CHECK_FALSE(read(sensor_yaml_text(sensor, "made"))->camera_state.told());
  using geometry::StateKey;
  sensor.camera_state = geometry::plain_state();
  sensor.camera_state[StateKey::MirrorY] = 1;
  sensor.camera_state[StateKey::SensorWidth] = 1626;
  sensor.camera_state[StateKey::BlackLevel] = 4.0625;
  sensor.camera_state.pixel_format = "Mono8";
  const auto sut = read(sensor_yaml_text(sensor, "made"));
  SUCCEEDS(sut);
  CHECK(sensor.camera_state == sut->camera_state);
  STRCMP_CONTAINS("  mirror_y: true\n", sensor_yaml_text(sensor, "made").c_str());
  FAILS_NAMING(Errc::BadValue, "camera_state.mirror_y", read(changed("mirror_y: true", "mirror_y: 3")));
  FAILS_NAMING(Errc::BadValue, "camera_state.binning_x", read(changed("binning_x: 1", "binning_x: 0")));
  FAILS_NAMING(Errc::BadValue, "camera_state.black_level",
               read(changed("black_level: 4.0625", "black_level: .nan")));
  FAILS_NAMING(Errc::UnknownKey, "camera_state.mirror_z", read(changed("mirror_y: true", "mirror_z: true")));
  sensor.camera_state = {};
  FAILS_NAMING(Errc::BadFormat, "camera_state",
               read(sensor_yaml_text(sensor, "made") + "camera_state: upright\n"));
}

TEST(SensorYaml, SpecklesContrastMayLack) {
  const std::string without = sensor_yaml_text(sensor, "made");
  CHECK(without.find("speckle_contrast") == std::string::npos);
  CHECK_FALSE(read(without)->speckle_contrast.has_value());
  sensor.speckle_contrast = 0.475;
  DOUBLES_EQUAL(0.475, read(sensor_yaml_text(sensor, "made"))->speckle_contrast.value_or(-1), 0);
  FAILS_NAMING(Errc::BadValue, "speckle_contrast",
               read(changed("speckle_contrast: 0.475", "speckle_contrast: -0.475")));
}

TEST(SensorYaml, WhatWasWrittenIsRead) {
  const auto sut = read(sensor_yaml_text(sensor, "made"));
  SUCCEEDS(sut);
  constexpr double k_tol = 1e-12;
  DOUBLES_EQUAL(sensor.camera.fu_px, sut->camera.fu_px, k_tol);
  DOUBLES_EQUAL(sensor.camera.p2, sut->camera.p2, k_tol);
  DOUBLES_EQUAL(0, (sensor.laser_plane.normal_cam - sut->laser_plane.normal_cam).norm(), k_tol);
  DOUBLES_EQUAL(sensor.laser_plane.distance_mm, sut->laser_plane.distance_mm, k_tol);
  TRANSFORMS_EQUAL(sensor.T_flange_cam, sut->T_flange_cam, k_tol, k_tol);
  LONGS_EQUAL(460, sut->region.offset_v_px);
  LONGS_EQUAL(3'700'000, sut->pose_clock_offset.count());
  DOUBLES_EQUAL(100, *sut->rate_hz, 0);
  LONGS_EQUAL(400'000, sut->exposure->count());
}

// A recording holds the head as it was read.
// With one digit less its replay's points differ in their last bit.
TEST(SensorYaml, WhatWasReadAndWrittenKeepsEveryBit) {
  std::mt19937 random{7};
  std::uniform_real_distribution<double> any{-2, 2};
  for (int i = 0; i < 200; ++i) {
    Twist motion;
    for (double& value : motion) value = any(random);
    sensor.T_flange_cam = geometry::exp_se3(motion);
    sensor.laser_plane.normal_cam = Vec3(any(random), any(random), any(random)).normalized();
    sensor.laser_plane.distance_mm = 100 * any(random);
    const auto once = read(sensor_yaml_text(sensor, "made"));
    SUCCEEDS(once);
    const auto again = read(sensor_yaml_text(*once, "written again"));
    SUCCEEDS(again);
    CHECK(once->T_flange_cam.matrix() == again->T_flange_cam.matrix());
    CHECK(once->laser_plane.normal_cam == again->laser_plane.normal_cam);
    CHECK(once->laser_plane.distance_mm == again->laser_plane.distance_mm);
    CHECK(once->camera.k1 == again->camera.k1);
  }
}

TEST(SensorYaml, RateAndExposureMayBeMissing) {
  sensor.rate_hz.reset();
  sensor.exposure.reset();
  const auto sut = read(sensor_yaml_text(sensor, "made"));
  SUCCEEDS(sut);
  CHECK(!sut->rate_hz && !sut->exposure);
}

TEST(SensorYaml, UnknownClockOffsetReadsAsAMissingOne) {
  const auto sut = read(changed("pose_clock_offset_ns: 3700000", "pose_clock_offset_ns: unknown"));
  SUCCEEDS(sut);
  LONGS_EQUAL(0, sut->pose_clock_offset.count());
}

TEST(SensorYaml, FaultsNameTheKey) {
  FAILS_NAMING(Errc::UnknownKey, "focal", read(changed("intrinsics:", "focal: 3\nintrinsics:")));
  FAILS_NAMING(Errc::BadFormat, "laser_plane: missing", read(changed("laser_plane:", "comment2:")));
  FAILS_NAMING(Errc::BadValue, "resolution", read(changed("[1626, 320]", "[1626.5, 320]")));
  FAILS_NAMING(Errc::BadValue, "intrinsics", read(changed("2730.5", ".nan")));
  FAILS_NAMING(Errc::NotSupported, "camera_model", read(changed("pinhole", "fisheye")));
}

TEST(SensorYaml, MatrixThatIsNoRigidMotionIsRefused) {
  FAILS_NAMING(Errc::BadValue, "T_flange_cam", read(changed("[0, 0, 0, 1]", "[0, 0, 1, 1]")));
}

}  // namespace biteline::config
