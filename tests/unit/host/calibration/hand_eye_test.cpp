// SPDX-License-Identifier: MIT
#include "host/calibration/handeye/hand_eye.hpp"

#include <CppUTest/TestHarness.h>

#include <cmath>
#include <numbers>
#include <random>

#include "host/calibration/handeye/motions.hpp"
#include "host/geometry/symmetric.hpp"
#include "tests/support/ring_scene.hpp"
#include "tests/support/transforms.hpp"

namespace biteline::calibration {

constexpr double k_degree = std::numbers::pi / 180;

TEST_GROUP(HandEye) {
  std::mt19937_64 random{31};
  std::normal_distribution<double> normal{0, 1};
  test::RingScene scene;
  double centre_noise_px = 0.03, pose_noise_mm = 0.02, pose_noise_rad = 1e-4;
  SE3 T_flange_cam = SE3::Identity();
  SE3 T_base_target = SE3::Identity();

  void setup() override {
    T_flange_cam.linear() =
        (Eigen::AngleAxisd(0.7, Vec3::UnitX()) * Eigen::AngleAxisd(0.1, Vec3::UnitZ())).toRotationMatrix();
    T_flange_cam.translation() = Vec3(10, 150, 250);
    T_base_target.linear() = Eigen::AngleAxisd(3.0, Vec3(1, 0.05, 0.02).normalized()).toRotationMatrix();
    T_base_target.translation() = Vec3(400, 100, 20);
  }

  Vec3 noise(double sigma) {
    return sigma * Vec3(normal(random), normal(random), normal(random));
  }

  /// A stop that looks at the target from a given place; the grid is read in a random one of its two ways.
  HandEyeView view_from(const test::ViewPlace& place, int number) {
    const SE3 T_cam_target = test::T_cam_target_of(scene.target, place);
    HandEyeView view{.name = "handeye/" + std::to_string(number),
                     .T_base_flange = T_base_target * (T_flange_cam * T_cam_target).inverse(),
                     .pose = {},
                     .readings = {}};
    PlaneView plane = test::exact_view(scene, T_cam_target, view.name, centre_noise_px, random);
    if (random() % 2 == 0) {
      for (CentreObservation& c : plane.centres)
        c.point_target = 2 * scene.target.middle_target() - c.point_target;
    }
    view.pose = *fit_plane_pose(scene.camera, plane.centres);
    view.readings = plane.grid.readings;
    view.T_base_flange.translation() += noise(pose_noise_mm);
    view.T_base_flange.linear() = view.T_base_flange.linear() * geometry::exp_so3(noise(pose_noise_rad));
    return view;
  }

  std::vector<HandEyeView> views(int count) {
    std::vector<HandEyeView> result;
    for (const test::ViewPlace& place : test::varied_places(count, random))
      result.push_back(view_from(place, static_cast<int>(result.size())));
    return result;
  }

  HandEyeOptions options() {
    return {.centre_sigma_px = centre_noise_px, .middle_target = scene.target.middle_target()};
  }

  void check_refused(const std::vector<HandEyeView>& spoiled, const char* word) {
    const auto result = calibrate_hand_eye(spoiled, options());
    CHECK_FALSE(result.has_value());
    CHECK(error_row(result.error().code).exit_status == ExitStatus::Refused);
    STRCMP_CONTAINS(word, result.error().where.c_str());
  }

  void check_named(const std::vector<HandEyeView>& spoiled, const std::vector<int>& odd) {
    const auto result = calibrate_hand_eye(spoiled, options());
    CHECK_TRUE_TEXT(result.has_value(), result ? "" : to_line(result.error()).c_str());
    LONGS_EQUAL(odd.size(), result->set_aside.size());
    for (std::size_t i = 0; i < odd.size(); ++i)
      STRCMP_EQUAL(spoiled[static_cast<std::size_t>(odd[i])].name.c_str(), result->set_aside[i].name.c_str());
    TRANSFORMS_EQUAL(T_flange_cam, result->T_flange_cam, 0.2, 0.03 * k_degree);
  }
};

TEST(HandEye, ExactWithoutNoiseWhateverTheReadings) {
  centre_noise_px = pose_noise_mm = pose_noise_rad = 0;
  const auto result =
      calibrate_hand_eye(views(8), {.centre_sigma_px = 0.03, .middle_target = scene.target.middle_target()});
  CHECK_TRUE_TEXT(result.has_value(), result ? "" : to_line(result.error()).c_str());
  TRANSFORMS_EQUAL(T_flange_cam, result->T_flange_cam, 1e-4, 1e-6);
  LONGS_EQUAL(8, result->stops.size());
}

TEST(HandEye, ErrorsAreAsSmallAsTheNoiseAllowsAndStatedHonestly) {
  // The stated covariance is the Cramer-Rao bound of the true noise, which the estimate must come near to:
  // the mean of the normalised square over 50 draws is 6 when both are right; the noise being estimated from
  // 13 views adds some.
  constexpr int k_draws = 50;
  double square = 0, error_mm2 = 0, bound_mm2 = 0, sigma_mm = 0, sigma_rad = 0;
  for (int draw = 0; draw < k_draws; ++draw) {
    const auto result = calibrate_hand_eye(views(13), options());
    CHECK(result.has_value());
    const Twist error = geometry::log_se3(T_flange_cam.inverse() * result->T_flange_cam);
    square += error.dot(geometry::solve_symmetric(result->covariance, error).col(0)) / k_draws;
    error_mm2 += error.head<3>().squaredNorm() / k_draws;
    bound_mm2 += result->covariance.topLeftCorner<3, 3>().trace() / k_draws;
    sigma_mm += result->pose_sigma_mm / k_draws;
    sigma_rad += result->pose_sigma_rad / k_draws;
  }
  CHECK_TRUE_TEXT(square < 6 * 1.6, StringFromFormat("normalised square %.2f", square).asCharString());
  CHECK(std::sqrt(error_mm2) < 1.3 * std::sqrt(bound_mm2));
  DOUBLES_EQUAL(pose_noise_mm, sigma_mm, 0.25 * pose_noise_mm);
  DOUBLES_EQUAL(pose_noise_rad, sigma_rad, 0.25 * pose_noise_rad);
}

TEST(HandEye, TwoRowsExchangedAreNamed) {
  std::vector<HandEyeView> spoiled = views(13);
  std::swap(spoiled[3].T_base_flange, spoiled[8].T_base_flange);
  check_named(spoiled, {3, 8});
}

TEST(HandEye, ShiftedRowIsNamed) {
  // Turned like the others, but 3 mm off: only the translations can tell.
  std::vector<HandEyeView> spoiled = views(13);
  spoiled[5].T_base_flange.translation() += Vec3(2, -2, 1);
  check_named(spoiled, {5});
}

TEST(HandEye, AllRowsShuffledIsRefused) {
  std::vector<HandEyeView> spoiled = views(13);
  std::vector<SE3> poses;
  for (const HandEyeView& view : spoiled) poses.push_back(view.T_base_flange);
  std::shuffle(poses.begin(), poses.end(), random);
  for (std::size_t i = 0; i < poses.size(); ++i) spoiled[i].T_base_flange = poses[i];
  check_refused(spoiled, "disagree");
}

TEST(HandEye, RowsInOppositeOrderIsSaid) {
  std::vector<HandEyeView> spoiled = views(12), order = spoiled;
  for (std::size_t i = 0; i < spoiled.size(); ++i)
    spoiled[i].T_base_flange = order[order.size() - 1 - i].T_base_flange;
  check_refused(spoiled, "opposite order");
}

TEST(HandEye, RowsOffByOneAreSaid) {
  for (const bool forward : {true, false}) {
    std::vector<HandEyeView> all = views(10);
    std::vector<SE3> poses;
    for (const HandEyeView& view : all) poses.push_back(view.T_base_flange);
    std::rotate(poses.begin(), forward ? poses.begin() + 1 : poses.end() - 1, poses.end());
    for (std::size_t i = 0; i < all.size(); ++i) all[i].T_base_flange = poses[i];
    check_refused(all, "off by one");
  }
}

TEST(HandEye, MetresForMillimetresIsSaid) {
  std::vector<HandEyeView> spoiled = views(13);
  for (HandEyeView& view : spoiled) view.T_base_flange.translation() /= 1000;
  check_refused(spoiled, "metres");
}

TEST(HandEye, WrongPitchIsSaid) {
  std::vector<HandEyeView> spoiled = views(13);
  for (HandEyeView& view : spoiled) {
    view.pose.T_cam_target.translation() *= 1.03;
    for (Reading& reading : view.readings) reading.T_this_other.translation() *= 1.03;
  }
  check_refused(spoiled, "factor");
}

TEST(HandEye, InvertedPosesAreSaid) {
  std::vector<HandEyeView> spoiled = views(13);
  for (HandEyeView& view : spoiled) view.T_base_flange = view.T_base_flange.inverse();
  check_refused(spoiled, "inverted");
}

TEST(HandEye, QuaternionOrderIsSaid) {
  std::vector<HandEyeView> spoiled = views(13);
  for (HandEyeView& view : spoiled) {
    const Eigen::Quaterniond q(view.T_base_flange.linear());
    view.T_base_flange.linear() = Eigen::Quaterniond(q.x(), q.y(), q.z(), q.w()).toRotationMatrix();
  }
  check_refused(spoiled, "quaternions");
}

TEST(HandEye, MirroredPicturesAreSaid) {
  std::vector<HandEyeView> spoiled = views(13);
  const Mat3 M = Vec3(-1, 1, 1).asDiagonal();
  for (HandEyeView& view : spoiled) {
    // Seen flipped left to right, the plain grid reads as one of its own kind, mirrored about its middle
    // column.
    const SE3 T = view.pose.T_cam_target;
    view.pose.T_cam_target.linear() = M * T.linear() * M;
    view.pose.T_cam_target.translation() = M * (T * Vec3(2 * scene.target.middle_target().x(), 0, 0));
  }
  check_refused(spoiled, "mirror");
}

TEST(HandEye, OneAxisOnlyIsRefused) {
  std::vector<HandEyeView> all;
  for (int i = 0; i < 10; ++i)
    all.push_back(view_from({.distance_mm = 230.0 + 8 * i,
                             .shift_mm = Vec2(3.0 * i - 12, 5),
                             .roll_rad = 0.2,
                             .tilt_rad = -0.5 + 0.1 * i,
                             .tilt_axis_rad = 0.3},
                            i));
  check_refused(all, "parallel");
}

TEST(HandEye, TooLittleTurningIsRefused) {
  std::vector<HandEyeView> all;
  for (int i = 0; i < 10; ++i)
    all.push_back(view_from({.distance_mm = 240, .tilt_rad = 0.03, .tilt_axis_rad = 0.6 * i}, i));
  check_refused(all, "turned");
}

TEST(HandEye, ThreeViewsAreRefused) {
  check_refused(views(3), "at least 3");
}

TEST(HandEye, ShiftedReadingsAreResolved) {
  // A grid that lost a column may be read one pitch off: only the motions tell.  More than half lost theirs.
  std::vector<HandEyeView> all = views(12);
  for (const std::size_t i : {0U, 2U, 3U, 5U, 7U, 8U, 10U}) {
    HandEyeView& view = all[i];
    const SE3 shift(Eigen::Translation3d(scene.target.pitch_mm, 0, 0));
    view.pose.T_cam_target = view.pose.T_cam_target * shift;
    std::vector<Reading> readings = view.readings;
    for (const Reading& reading : readings)
      view.readings.push_back({.T_this_other = shift.inverse() * reading.T_this_other});
  }
  const auto result = calibrate_hand_eye(all, options());
  CHECK_TRUE_TEXT(result.has_value(), result ? "" : to_line(result.error()).c_str());
  LONGS_EQUAL(0, result->set_aside.size());
  TRANSFORMS_EQUAL(T_flange_cam, result->T_flange_cam, 0.2, 0.03 * k_degree);
}

TEST(HandEye, LinearStepsSolveAKnownCase) {
  pose_noise_mm = pose_noise_rad = 0;
  std::vector<Stop> stops;
  for (const test::ViewPlace& place : test::varied_places(5, random)) {
    const SE3 T_cam_target = test::T_cam_target_of(scene.target, place);
    stops.push_back({.T_base_flange = T_base_target * (T_flange_cam * T_cam_target).inverse(),
                     .T_cam_target = T_cam_target});
  }
  const auto R = rotation_of_x(stops);
  DOUBLES_EQUAL(0.0, (*R - T_flange_cam.linear()).norm(), 1e-9);
  const auto fit = translation_of_x(stops, *R);
  DOUBLES_EQUAL(0.0, (fit->translation_mm - T_flange_cam.translation()).norm(), 1e-6);
  DOUBLES_EQUAL(1.0, fit->pose_scale, 1e-9);
}

}  // namespace biteline::calibration
