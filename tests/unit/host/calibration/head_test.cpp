// SPDX-License-Identifier: MIT
#include <CppUTest/TestHarness.h>

#include <cmath>

#include "host/calibration/camera/reprojection.hpp"
#include "host/calibration/handeye/pose_adjustment.hpp"
#include "host/calibration/head/comparison.hpp"
#include "host/calibration/head/head_calibration.hpp"
#include "tests/support/ring_scene.hpp"
#include "tests/support/transforms.hpp"

namespace biteline::calibration {

TEST_GROUP(Head) {
  test::RingScene scene;
  geometry::SensorModel before;
  HeadFit now;

  void setup() override {
    before.camera = scene.camera;
    before.laser_plane = {.normal_cam = Vec3(0, 0.7, -0.7).normalized(), .distance_mm = -150};
    before.T_flange_cam.linear() = Eigen::AngleAxisd(0.7, Vec3::UnitX()).toRotationMatrix();
    before.T_flange_cam.translation() = Vec3(10, 150, 250);
    now.state.camera = before.camera;
    now.state.plane = before.laser_plane;
    now.state.T_flange_cam = before.T_flange_cam;
    now.plane_middle_cam = geometry::triangulate(before.camera, before.laser_plane, Vec2(400, 300));
    now.plane_axes.col(0) = Vec3::UnitX();
    now.plane_axes.col(1) = before.laser_plane.normal_cam.cross(Vec3::UnitX());
    now.covariance.diagonal().tail<6>() << 4e-4, 4e-4, 4e-4, 1e-9, 1e-9, 1e-9;
  }
};

TEST(Head, TwiceTheSameHeadDidNotMove) {
  const Comparison sut = compare_heads(now, before, scene.size.width_px);
  DOUBLES_EQUAL(0.0, sut.largest_mm, 1e-9);
  CHECK_FALSE(sut.moved);
}

TEST(Head, ShiftedHeadMovedByTheShift) {
  now.state.T_flange_cam.translation() += Vec3(0.3, -0.4, 0);
  const Comparison sut = compare_heads(now, before, scene.size.width_px);
  DOUBLES_EQUAL(0.5, sut.rms_mm, 1e-9);
  DOUBLES_EQUAL(0.3, sut.shift_flange_mm.x(), 1e-9);
  CHECK(sut.moved);
}

TEST(Head, ShiftWithinItsUncertaintyIsNoMove) {
  now.state.T_flange_cam.translation() += Vec3(0, 0.03, 0);
  CHECK_FALSE(compare_heads(now, before, scene.size.width_px).moved);
}

TEST(Head, ProjectionForDerivativesIsTheCamerasOwn) {
  const CameraVector parameters = to_parameters(scene.camera);
  for (const Vec3& point_cam : {Vec3(10, -20, 250), Vec3(-60, 45, 310), Vec3(0, 0, 100)}) {
    DOUBLES_EQUAL(
        0.0, (project<double>(parameters.data(), point_cam) - scene.camera.project(point_cam)).norm(), 1e-10);
  }
}

TEST(Head, PerturbationIsTheFirstOrderOfExp) {
  const Twist xi = (Twist() << 1e-4, -2e-4, 3e-4, 2e-6, -1e-6, 3e-6).finished();
  TRANSFORMS_EQUAL(geometry::exp_se3(xi), perturbation(xi.data()), 1e-8, 1e-12);
}

TEST(Head, AdjointCarriesAPerturbationAcross) {
  const SE3 T = before.T_flange_cam;
  const Twist xi = (Twist() << 1, -2, 3, 0.1, -0.2, 0.05).finished();
  TRANSFORMS_EQUAL(T * geometry::exp_se3(xi), geometry::exp_se3(adjoint(T) * xi) * T, 1e-9, 1e-12);
}

TEST(Head, NeitherPicturesNorAKnownCameraIsAMistakeOfUse) {
  const HeadCalibration sut = calibrate_head({});
  CHECK(sut.refused.has_value());
  CHECK(sut.refused->code == Errc::InvalidArgument);
}

}  // namespace biteline::calibration
