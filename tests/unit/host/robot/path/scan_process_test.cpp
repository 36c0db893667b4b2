// SPDX-License-Identifier: MIT
#include "host/robot/path/scan_process.hpp"

#include <CppUTest/TestHarness.h>

#include <cmath>
#include <numbers>

#include "host/robot/path/plan.hpp"
#include "tests/unit/host/robot/path/made_line.hpp"

namespace biteline::path {

TEST_GROUP(ScanProcess) {
  geometry::SensorModel sensor;

  void setup() override {
    // Laser and camera axis meet at 45 degrees, 200 mm before the camera; the plane leans about the image's
    // x, and a little askew so that a forgotten projection shows.
    sensor.laser_plane.normal_cam =
        Vec3{0.02, std::sin(std::numbers::pi / 4), -std::cos(std::numbers::pi / 4)}.normalized();
    sensor.laser_plane.distance_mm = sensor.laser_plane.normal_cam.dot(Vec3{0, 0, 200});
    sensor.T_flange_cam =
        geometry::make_se3(Eigen::Quaterniond{Eigen::AngleAxisd{0.4, Vec3::UnitX()}}, Vec3{10, -60, 40});
  }
};

TEST(ScanProcess, TipIsOnAxisAndPlaneAndTravelGoesAcrossThePlane) {
  for (const bool turned : {false, true}) {
    const auto process = scan_process(sensor, {.turned = turned});
    CHECK(process.has_value());
    const SE3 T_cam_tcp = sensor.T_flange_cam.inverse() * process->tool.T_flange_tcp;
    DOUBLES_EQUAL(0.0, (T_cam_tcp.translation() - Vec3{0, 0, 200}).norm(), 1e-9);
    DOUBLES_EQUAL(0.0, sensor.laser_plane.signed_distance_mm(T_cam_tcp.translation()), 1e-9);
    DOUBLES_EQUAL(1.0, T_cam_tcp.linear().determinant(), 1e-9);
    const Mat3 R = T_cam_tcp.linear();
    DOUBLES_EQUAL(1.0, std::abs(R.col(0).dot(sensor.laser_plane.normal_cam)), 1e-9);  // travel
    DOUBLES_EQUAL(0.0, R.col(2).dot(sensor.laser_plane.normal_cam), 1e-9);            // beam
    CHECK(R.col(2).z() > 0);
    CHECK(R.col(1).x() * (turned ? 1 : -1) >
          0.99);  // the wall's foot is at the image's left, or at its right
  }
}

TEST(ScanProcess, SpeedFollowsFromRateAndSpacing) {
  DOUBLES_EQUAL(120, scan_process(sensor, {.rate_hz = 150, .spacing_mm = 0.8})->motion.speed_mm_s, 1e-9);
}

TEST(ScanProcess, PlaneThatTheAxisDoesNotMeetIsRefused) {
  sensor.laser_plane.normal_cam = Vec3::UnitX();
  CHECK(scan_process(sensor, {}).error().code == Errc::Degenerate);
}

TEST(ScanProcess, AShoeIsScannedInLessThanTenSecondsWithEveryCheckPassed) {
  // The beam at right angles to the flange, the camera beside it: a head that reaches over the shoe's far
  // side.
  SE3 T_tcp_flange = SE3::Identity();
  T_tcp_flange.linear() = (Eigen::AngleAxisd{-1.0, Vec3::UnitX()}).toRotationMatrix();
  T_tcp_flange.translation() = Vec3{0, -160, -150};
  const Process plain = *scan_process(sensor, {});
  sensor.T_flange_cam = T_tcp_flange.inverse() * plain.tool.T_flange_tcp.inverse() * sensor.T_flange_cam;
  PlanRequest request{.line = test::made_line(),
                      .process = *scan_process(sensor, {}),
                      .arm = *kinematics::arm_model("UR10e"),
                      .T_line_base = SE3::Identity(),
                      .table_z_mm = 40,
                      .shoe = {},
                      .cloud = {}};
  const PlanOutcome outcome = plan(request);
  CHECK_TEXT(outcome.path.has_value(), outcome.reason().c_str());
  CHECK(outcome.path->duration_s() < 10);
}

}  // namespace biteline::path
