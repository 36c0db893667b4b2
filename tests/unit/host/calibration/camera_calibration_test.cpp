// SPDX-License-Identifier: MIT
#include "host/calibration/camera/camera_calibration.hpp"

#include <CppUTest/TestHarness.h>

#include <cmath>

#include "host/calibration/camera/plane_pose.hpp"
#include "host/calibration/rings/homography.hpp"
#include "host/geometry/symmetric.hpp"
#include "tests/support/ring_scene.hpp"
#include "tests/support/transforms.hpp"

namespace biteline::calibration {

TEST_GROUP(CameraCalibration) {
  std::mt19937_64 random{23};
  test::RingScene scene;
  static constexpr double k_noise_px = 0.03;

  std::vector<PlaneView> views(int count) {
    std::vector<PlaneView> result;
    for (const test::ViewPlace& place : test::varied_places(count, random)) {
      result.push_back(test::exact_view(scene, test::T_cam_target_of(scene.target, place),
                                        "view " + std::to_string(result.size()), k_noise_px, random));
    }
    return result;
  }
};

TEST(CameraCalibration, ClosedFormIsExactWithoutDistortionAndNoise) {
  scene.camera.k1 = scene.camera.k2 = scene.camera.p1 = scene.camera.p2 = 0;
  std::vector<Mat3> homographies;
  for (const test::ViewPlace& place : test::varied_places(5, random)) {
    std::vector<PlanePoint> points;
    for (const auto& c :
         test::exact_view(scene, test::T_cam_target_of(scene.target, place), "", 0, random).centres) {
      points.push_back({.plane = c.point_target.head<2>(), .image = c.pixel_px});
    }
    homographies.push_back(*fit_homography(points));
  }
  const auto camera = closed_form_camera(homographies, scene.size);
  CHECK(camera.has_value());
  DOUBLES_EQUAL(scene.camera.fu_px, camera->fu_px, 1e-3);
  DOUBLES_EQUAL(scene.camera.fv_px, camera->fv_px, 1e-3);
  DOUBLES_EQUAL(scene.camera.cu_px, camera->cu_px, 1e-3);
  DOUBLES_EQUAL(scene.camera.cv_px, camera->cv_px, 1e-3);
}

TEST(CameraCalibration, TruthLiesWithinTheStatedUncertainty) {
  const auto result = calibrate_camera(views(12), scene.size);
  CHECK_TRUE_TEXT(result.has_value(), result ? "" : to_line(result.error()).c_str());
  const CameraVector sigma = result->sigma();
  DOUBLES_EQUAL(scene.camera.fu_px, result->camera.fu_px, 4 * sigma[0]);
  DOUBLES_EQUAL(scene.camera.fv_px, result->camera.fv_px, 4 * sigma[1]);
  DOUBLES_EQUAL(scene.camera.cu_px, result->camera.cu_px, 4 * sigma[2]);
  DOUBLES_EQUAL(scene.camera.cv_px, result->camera.cv_px, 4 * sigma[3]);
  DOUBLES_EQUAL(scene.camera.k1, result->camera.k1, 4 * sigma[4]);
  DOUBLES_EQUAL(k_noise_px, result->sigma_px, 0.1 * k_noise_px);  // 12 x 28 x 2 residuals: 4 %
  DOUBLES_EQUAL(0.0, result->camera.k3, 0);                       // not in the scene: left out
  LONGS_EQUAL(0, result->set_aside.size());
}

TEST(CameraCalibration, PictureOfAnotherCameraIsNamed) {
  std::vector<PlaneView> all = views(10);
  test::RingScene other = scene;
  other.camera.fu_px *= 1.15;
  other.camera.fv_px *= 1.15;
  other.camera.cu_px += 25;
  all.insert(all.begin() + 4,
             test::exact_view(other,
                              test::T_cam_target_of(
                                  scene.target, {.distance_mm = 280, .tilt_rad = 0.5, .tilt_axis_rad = 1}),
                              "the stranger", k_noise_px, random));
  const auto result = calibrate_camera(all, scene.size);
  CHECK_TRUE_TEXT(result.has_value(), result ? "" : to_line(result.error()).c_str());
  LONGS_EQUAL(1, result->set_aside.size());
  STRCMP_EQUAL("the stranger", result->set_aside[0].name.c_str());
  DOUBLES_EQUAL(scene.camera.fu_px, result->camera.fu_px, 4 * result->sigma()[0]);
}

TEST(CameraCalibration, DamagedRingIsSetAside) {
  std::vector<PlaneView> all = views(8);
  all[3].centres[9].pixel_px += Vec2(0.8, -0.5);
  const auto result = calibrate_camera(all, scene.size);
  CHECK(result.has_value());
  LONGS_EQUAL(1, result->views[3].rings_set_aside);
  LONGS_EQUAL(27, result->views[3].view.centres.size());
}

TEST(CameraCalibration, TwoViewsAreRefused) {
  const auto result = calibrate_camera(views(2), scene.size);
  CHECK_FALSE(result.has_value());
  CHECK(error_row(result.error().code).exit_status == ExitStatus::Refused);
}

TEST(CameraCalibration, ViewsParallelToTheSensorAreRefused) {
  std::vector<PlaneView> all;
  for (int i = 0; i < 6; ++i) {
    all.push_back(test::exact_view(
        scene, test::T_cam_target_of(scene.target, {.distance_mm = 240.0 + 10 * i, .roll_rad = 0.2 * i}),
        "flat", k_noise_px, random));
  }
  const auto result = calibrate_camera(all, scene.size);
  CHECK_FALSE(result.has_value());
  CHECK(error_row(result.error().code).exit_status == ExitStatus::Refused);
}

TEST(CameraCalibration, PoseOfAPlaneIsExactAndItsCovarianceHonest) {
  const SE3 T = test::T_cam_target_of(
      scene.target,
      {.distance_mm = 260, .shift_mm = Vec2(5, -8), .roll_rad = 0.4, .tilt_rad = 0.5, .tilt_axis_rad = 1.2});
  const auto exact = fit_plane_pose(scene.camera, test::exact_view(scene, T, "", 0, random).centres);
  TRANSFORMS_EQUAL(T, exact->T_cam_target, 1e-6, 1e-8);
  double sum = 0;
  constexpr int k_draws = 100;
  for (int i = 0; i < k_draws; ++i) {
    const auto noisy =
        fit_plane_pose(scene.camera, test::exact_view(scene, T, "", k_noise_px, random).centres);
    const Twist error = geometry::log_se3(T.inverse() * noisy->T_cam_target);
    sum += error.dot(geometry::solve_symmetric(noisy->covariance_per_px2, error).col(0)) /
           (k_noise_px * k_noise_px);
  }
  DOUBLES_EQUAL(6.0, sum / k_draws,
                4 * std::sqrt(2 * 6.0 / k_draws));  // chi-squared with 6 degrees of freedom
}

TEST(CameraCalibration, RingsSeenWronglyCostOnlyThemselves) {
  const SE3 T = test::T_cam_target_of(
      scene.target,
      {.distance_mm = 260, .shift_mm = Vec2(5, -8), .roll_rad = 0.4, .tilt_rad = 0.5, .tilt_axis_rad = 1.2});
  PlaneView view = test::exact_view(scene, T, "", k_noise_px, random);
  // A glare over one corner of the target.
  const std::size_t rings = view.centres.size();
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < rings; ++i) {
    if (view.grid.rings[i].row > 1 || view.grid.rings[i].col > 2) continue;
    view.centres[i].pixel_px += Vec2(0.8, -0.5);
    ++wrong;
  }
  LONGS_EQUAL(6, wrong);
  const auto chi2 = [&](const PlanePose& pose) {
    const Twist error = geometry::log_se3(T.inverse() * pose.T_cam_target);
    return error.dot(geometry::solve_symmetric(pose.covariance_per_px2, error).col(0)) /
           (k_noise_px * k_noise_px);
  };
  const auto all = fit_plane_pose(scene.camera, view.centres);
  CHECK(chi2(*all) > 100);
  const auto pose = fit_view_pose(scene.camera, view);
  CHECK(pose.has_value());
  LONGS_EQUAL(rings - wrong, view.centres.size());
  LONGS_EQUAL(view.centres.size(), view.grid.rings.size());
  CHECK(chi2(*pose) < 22.5);  // 6 degrees of freedom: one in a thousand lies beyond
}

}  // namespace biteline::calibration
