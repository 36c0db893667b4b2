// SPDX-License-Identifier: MIT
#include "host/calibration/laser/laser_calibration.hpp"

#include <CppUTest/TestHarness.h>

#include <cmath>
#include <numbers>

#include "host/calibration/refine/head_bundle.hpp"
#include "tests/support/made_stripe.hpp"
#include "tests/support/ring_scene.hpp"
#include "tests/support/transforms.hpp"

namespace biteline::calibration {

TEST_GROUP(Laser) {
  std::mt19937_64 random{17};
  std::normal_distribution<double> normal{0, 1};
  test::RingScene scene;
  geometry::LaserPlane truth{.normal_cam = Vec3(0.01, 0.704, -0.71).normalized(), .distance_mm = -150};
  double centre_noise_px = 0.03, stripe_noise_px = 0.05;
  SE3 T_plane1_plane2 = SE3::Identity();

  void setup() override {
    scene.target = {
        .rows = 4, .cols = 3, .pitch_mm = 14, .outer_diameter_mm = 12, .inner_diameter_mm = 6, .planes = 2};
    // 88 degrees, told to nobody.
    T_plane1_plane2.linear() =
        Eigen::AngleAxisd(-88 * std::numbers::pi / 180, Vec3::UnitY()).toRotationMatrix();
    T_plane1_plane2.translation() = Vec3(38, 0, 10);
  }

  /// Where the laser plane meets a target's plane, seen from its first to its last column.
  void add_stripe(const SE3& T_cam_plane, std::vector<StripePoint>& stripe) {
    for (double x_mm = -5; x_mm <= 33; x_mm += 1.5) {
      // n . (T (x, y, 0)) = d, linear in y.
      const Vec3 at = T_cam_plane * Vec3(x_mm, 0, 0);
      const double y_mm = -truth.signed_distance_mm(at) / truth.normal_cam.dot(T_cam_plane.linear().col(1));
      if (y_mm < -5 || y_mm > 47) continue;
      const Vec2 pixel_px = scene.camera.project(T_cam_plane * Vec3(x_mm, y_mm, 0));
      stripe.push_back(
          {.pixel_px = pixel_px + Vec2(0, stripe_noise_px * normal(random)), .sigma_px = stripe_noise_px});
    }
  }

  std::vector<LaserPictures> places(int count) {
    std::vector<LaserPictures> result;
    for (int i = 0; i < count; ++i) {
      SE3 T_cam_plane1 = SE3::Identity();
      T_cam_plane1.linear() =
          (Eigen::AngleAxisd(0.05 * i, Vec3::UnitX()) * Eigen::AngleAxisd(0.8 - 0.06 * i, Vec3::UnitY()))
              .toRotationMatrix();
      T_cam_plane1.translation() = Vec3(-25 + 2.0 * i, -22, 216 + 2.0 * i);
      LaserPictures place{.name = "laser/" + std::to_string(i), .planes = {}, .stripe = {}};
      for (const SE3& T : {T_cam_plane1, SE3(T_cam_plane1 * T_plane1_plane2)}) {
        place.planes.push_back(test::exact_view(scene, T, place.name, centre_noise_px, random));
        add_stripe(T, place.stripe);
      }
      if (i % 2 == 1) std::swap(place.planes[0], place.planes[1]);  // found in any order
      result.push_back(std::move(place));
    }
    return result;
  }

  void check_plane(const geometry::LaserPlane& plane, const Vec3& middle_cam, double tolerance_mm) {
    for (const Vec3& offset : {Vec3(0, 0, 0), Vec3(30, 0, 0), Vec3(-30, 0, 0), Vec3(0, 20, 20)}) {
      Vec3 at = middle_cam + offset;
      at -= truth.signed_distance_mm(at) * truth.normal_cam;
      DOUBLES_EQUAL(0.0, plane.signed_distance_mm(at), tolerance_mm);
    }
  }
};

TEST(Laser, ExactWithoutNoise) {
  centre_noise_px = stripe_noise_px = 0;
  auto all = places(5);
  for (LaserPictures& place : all) {
    for (StripePoint& p : place.stripe) p.sigma_px = 0.05;
  }
  const auto result = calibrate_laser(scene.camera, all);
  CHECK_TRUE_TEXT(result.has_value(), result ? "" : to_line(result.error()).c_str());
  check_plane(result->plane, result->middle_cam, 1e-5);
  CHECK(result->plane.distance_mm < 0);
  CHECK(result->two_planes);
  DOUBLES_EQUAL(88.0, std::acos(result->T_plane1_plane2.linear()(2, 2)) * 180 / std::numbers::pi, 1e-4);
}

TEST(Laser, SpecklesContrastIsTheMedianOfThePicturesThatShowIt) {
  auto all = places(6);
  CHECK(!calibrate_laser(scene.camera, all)->speckle_contrast);
  all[0].speckle_contrast = 0.9;
  all[2].speckle_contrast = 0.45;
  all[4].speckle_contrast = 0.4;
  DOUBLES_EQUAL(0.45, calibrate_laser(scene.camera, all)->speckle_contrast.value_or(0), 0);
}

TEST(Laser, NoiseGivesHundredthsOfAMillimetre) {
  const auto result = calibrate_laser(scene.camera, places(6));
  CHECK_TRUE_TEXT(result.has_value(), result ? "" : to_line(result.error()).c_str());
  LONGS_EQUAL_TEXT(0, result->set_aside.size(),
                   result->set_aside.empty() ? "" : result->set_aside[0].reason.c_str());
  check_plane(result->plane, result->middle_cam, 0.05);
}

TEST(Laser, AdjustmentStatesItsUncertaintyHonestly) {
  double square = 0;
  constexpr int k_draws = 12;
  for (int draw = 0; draw < k_draws; ++draw) {
    const auto alone = calibrate_laser(scene.camera, places(6));
    CHECK(alone.has_value());
    HeadObservations seen;
    for (const LaserView& view : alone->views) {
      seen.stripe.push_back({.planes = view.pictures.planes,
                             .T_cam_plane = view.T_cam_plane,
                             .rigid = view.rigid,
                             .points = view.points});
    }
    seen.centre_sigma_px = centre_noise_px;
    seen.camera_known = true;
    HeadState start;
    start.camera = scene.camera;
    start.plane = alone->plane;
    start.T_plane1_plane2 = alone->T_plane1_plane2;
    const HeadFit fit = solve_head(seen, start);
    CHECK(fit.converged);
    check_plane(fit.state.plane, fit.plane_middle_cam, 0.03);
    const Vec2 pixel_px = scene.camera.project(fit.plane_middle_cam);
    const Vec3 error = geometry::triangulate(scene.camera, fit.state.plane, pixel_px) -
                       geometry::triangulate(scene.camera, truth, pixel_px);
    square += std::pow(error.z() / fit.triangulation_sigma_mm(pixel_px).z(), 2) / k_draws;
  }
  CHECK_TRUE_TEXT(square < 1 + 4 * std::sqrt(2.0 / k_draws),
                  StringFromFormat("normalised square %.2f", square).asCharString());
}

TEST(Laser, PictureWithoutStripeIsNamed) {
  auto all = places(6);
  all[2].stripe.clear();
  const auto result = calibrate_laser(scene.camera, all);
  CHECK(result.has_value());
  LONGS_EQUAL(1, result->set_aside.size());
  STRCMP_EQUAL("laser/2", result->set_aside[0].name.c_str());
  STRCMP_CONTAINS("no stripe", result->set_aside[0].reason.c_str());
  check_plane(result->plane, result->middle_cam, 0.05);
}

TEST(Laser, TargetMovedBetweenThePicturesIsNamed) {
  auto all = places(6);
  for (StripePoint& p : all[4].stripe) p.pixel_px.y() += 4;
  const auto result = calibrate_laser(scene.camera, all);
  CHECK(result.has_value());
  LONGS_EQUAL(1, result->set_aside.size());
  STRCMP_EQUAL("laser/4", result->set_aside[0].name.c_str());
}

TEST(Laser, SpecksDoNotCount) {
  auto all = places(6);
  for (LaserPictures& place : all) place.stripe[5].pixel_px.y() -= 12;
  const auto result = calibrate_laser(scene.camera, all);
  CHECK(result.has_value());
  CHECK(result->points_set_aside >= 5);
  check_plane(result->plane, result->middle_cam, 0.05);
}

TEST(Laser, StripeStandsOutOfItsPicturesOwnNoise) {
  for (const float read_noise_grey : {0.8F, 8.0F}) {
    stripe::test::MadeStripe made;
    made.width_px = 400;
    made.height_px = 600;
    made.amplitude = 150;
    made.noise.read_noise_grey = read_noise_grey;
    made.row_px = [](int u) { return 280.3 + 0.1 * u; };
    const auto stripe = find_stripe({.width_px = made.width_px,
                                     .height_px = made.height_px,
                                     .pixels = stripe::test::picture(made, random)});
    CHECK(stripe.has_value());
    CHECK(stripe->points.size() > 0.95 * made.width_px);
    // This light has no speckle.  Told is no more than what all of the camera's noise would make, and half as
    // much again: a hundred columns err by an eighth.
    const double noise_grey = std::hypot(static_cast<double>(read_noise_grey),
                                         std::sqrt(made.noise.gain_grey_per_electron * made.amplitude));
    CHECK_COMPARE(stripe->speckle_contrast.value_or(1), <, 1.5 * noise_grey / made.amplitude);
    double sum_normalised = 0;
    for (const StripePoint& p : stripe->points) {
      const double error_px = p.pixel_px.y() - made.row_px(static_cast<int>(p.pixel_px.x()));
      CHECK(std::abs(error_px) < 2);
      sum_normalised += std::pow(error_px / p.sigma_px, 2);
    }
    // Below 1: speckle is reckoned with, and there is none here.
    const double level = std::sqrt(sum_normalised / static_cast<double>(stripe->points.size()));
    CHECK_TEXT(level > 0.15 && level < 1.5, StringFromFormat("level %g", level).asCharString());
  }
}

TEST(Laser, TwoPlacesAreRefused) {
  const auto result = calibrate_laser(scene.camera, places(2));
  CHECK_FALSE(result.has_value());
  CHECK(error_row(result.error().code).exit_status == ExitStatus::Refused);
}

TEST(Laser, OneLineIsRefused) {
  auto all = places(4);
  for (LaserPictures& place : all) {
    place = all[0];
    place.planes.resize(1);
  }
  const auto result = calibrate_laser(scene.camera, all);
  CHECK_FALSE(result.has_value());
  CHECK(result.error().code == Errc::Degenerate);
}

}  // namespace biteline::calibration
