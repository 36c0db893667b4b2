// SPDX-License-Identifier: MIT
#include "host/calibration/rings/grid.hpp"

#include <CppUTest/TestHarness.h>

#include <cmath>
#include <numbers>

#include "tests/support/ring_scene.hpp"
#include "tests/support/transforms.hpp"

namespace biteline::calibration {

TEST_GROUP(Grid) {
  std::mt19937_64 random{5};
  test::RingScene scene;
  test::PictureOptions options;

  static constexpr double k_degree = std::numbers::pi / 180;

  /// Rings as the detector would give them, without a picture: shuffled.
  std::vector<Ring> rings_of(const SE3& T_cam_target) {
    Mat3 H;
    H << T_cam_target.linear().col(0), T_cam_target.linear().col(1), T_cam_target.translation();
    Mat3 K = Mat3::Identity();
    K(0, 0) = scene.camera.fu_px;
    K(1, 1) = scene.camera.fv_px;
    K(0, 2) = scene.camera.cu_px;
    K(1, 2) = scene.camera.cv_px;
    std::vector<Ring> rings;
    for (int row = 0; row < scene.target.rows; ++row) {
      for (int col = 0; col < scene.target.cols; ++col) {
        const Vec3 place = scene.target.ring_target(row, col);
        Ring ring;
        ring.outer = *project_circle(K * H, place.head<2>(), scene.target.outer_diameter_mm / 2);
        ring.inner = *project_circle(K * H, place.head<2>(), scene.target.inner_diameter_mm / 2);
        ring.centre_px = scene.camera.project(T_cam_target * place);
        rings.push_back(ring);
      }
    }
    std::shuffle(rings.begin(), rings.end(), random);
    return rings;
  }

  /// The view's numbering is the target's, in one of its readings.
  void check_numbering(const GridView& view, const SE3& T_cam_target, double tolerance_px) {
    double best_px = 1e9;
    for (const Reading& reading : view.readings) {
      double worst_px = 0;
      for (const GridRing& ring : view.rings) {
        const Vec3 place = reading.T_this_other.inverse() * scene.target.ring_target(ring.row, ring.col);
        worst_px =
            std::max(worst_px, (scene.camera.project(T_cam_target * place) - ring.ring.centre_px).norm());
      }
      best_px = std::min(best_px, worst_px);
    }
    CHECK_TRUE_TEXT(best_px < tolerance_px,
                    StringFromFormat("worst ring %.3f px off in the best reading", best_px).asCharString());
  }
};

TEST(Grid, EveryRotationAndTiltIsSorted) {
  for (int roll = 0; roll < 360; roll += 17) {
    for (const int tilt : {0, 25, 45}) {
      const SE3 T = test::T_cam_target_of(scene.target, {.distance_mm = 300,
                                                         .roll_rad = roll * k_degree,
                                                         .tilt_rad = tilt * k_degree,
                                                         .tilt_axis_rad = 0.7});
      const auto views = find_grids(rings_of(T), scene.target, 1);
      LONGS_EQUAL(1, views.size());
      LONGS_EQUAL(0, views[0].missing);
      LONGS_EQUAL(2, views[0].readings.size());
      check_numbering(views[0], T, 1e-6);
    }
  }
}

TEST(Grid, SquareGridHasFourReadings) {
  scene.target = {.rows = 5, .cols = 5, .pitch_mm = 10, .outer_diameter_mm = 7, .inner_diameter_mm = 3};
  const SE3 T = test::T_cam_target_of(scene.target, {.roll_rad = 1.1, .tilt_rad = 0.4});
  const auto views = find_grids(rings_of(T), scene.target, 1);
  LONGS_EQUAL(1, views.size());
  LONGS_EQUAL(4, views[0].readings.size());
  check_numbering(views[0], T, 1e-6);
}

TEST(Grid, MissingRingsCostOnlyThemselves) {
  const SE3 T = test::T_cam_target_of(scene.target, {.roll_rad = 0.3, .tilt_rad = 0.5, .tilt_axis_rad = 2});
  std::vector<Ring> rings = rings_of(T);
  rings.resize(20);
  const auto views = find_grids(rings, scene.target, 1);
  LONGS_EQUAL(1, views.size());
  CHECK(views[0].rings.size() >= 18);  // a ring with no neighbour at all may stay out
  check_numbering(views[0], T, 1e-6);
}

TEST(Grid, MissingOuterRowAddsReadings) {
  const SE3 T = test::T_cam_target_of(scene.target, {.tilt_rad = 0.5});
  std::vector<Ring> rings = rings_of(T);
  const Vec2 corner_px = scene.camera.project(T * scene.target.ring_target(3, 3));
  std::erase_if(rings, [&](const Ring& ring) { return ring.centre_px.y() > corner_px.y() - 30; });
  LONGS_EQUAL(21, rings.size());
  const auto views = find_grids(rings, scene.target, 1);
  LONGS_EQUAL(1, views.size());
  LONGS_EQUAL(4, views[0].readings.size());
  check_numbering(views[0], T, 1e-6);
}

TEST(Grid, TwoPlanesOfACornerAreKeptApart) {
  scene.target = {.rows = 4, .cols = 3, .pitch_mm = 14, .outer_diameter_mm = 12, .inner_diameter_mm = 6};
  // An edge towards the camera, grids one pitch apart along it: in the picture the eight columns look like
  // one lattice.
  SE3 T_left = SE3::Identity(), T_right = SE3::Identity();
  T_left.linear() = Eigen::AngleAxisd(0.8, Vec3::UnitY()).toRotationMatrix();
  T_right.linear() = Eigen::AngleAxisd(-0.77, Vec3::UnitY()).toRotationMatrix();
  T_left.translation() = Vec3(0, -20, 250) - T_left.linear() * Vec3(35, 0, 0);
  T_right.translation() = Vec3(0, -20, 250) + T_right.linear() * Vec3(7, 0, 0);
  std::vector<Ring> rings = rings_of(T_left);
  for (const Ring& ring : rings_of(T_right)) rings.push_back(ring);
  std::shuffle(rings.begin(), rings.end(), random);
  const auto views = find_grids(rings, scene.target, 2);
  LONGS_EQUAL(2, views.size());
  LONGS_EQUAL(0, views[0].missing + views[1].missing);
  const bool left_first =
      std::abs(views[0].rings[0].ring.centre_px.x() - scene.camera.project(T_left.translation()).x()) < 100 &&
      views[0].rings[0].ring.centre_px.x() < scene.camera.cu_px;
  check_numbering(views[0], left_first ? T_left : T_right, 1e-6);
  check_numbering(views[1], left_first ? T_right : T_left, 1e-6);
}

TEST(Grid, PictureWithUnevenLightBlurAndACoveredRing) {
  const SE3 T = test::T_cam_target_of(
      scene.target, {.distance_mm = 250, .roll_rad = 0.5, .tilt_rad = 45 * k_degree, .tilt_axis_rad = 0.4});
  options.light = [](double u, double v) { return 0.35 + 0.9 * u * (1 - 0.4 * v); };
  options.blur_px = 1.5;
  options.samples = 3;
  const Vec2 covered = scene.target.ring_target(1, 2).head<2>();
  options.covered = [&](const Vec2& place) { return (place - covered - Vec2(4, 3)).norm() < 5.5; };
  const auto views = find_grids(test::draw_rings(scene, {T}, options, random), scene.target, 1);
  LONGS_EQUAL(1, views.size());
  LONGS_EQUAL(1, views[0].missing);
  // Blur 1.5 px, noise 2 of 140 grey levels over some 60 edge points: 0.01 px; the pair amplifies by 2.4;
  // three of these.
  check_numbering(views[0], T, 0.1);
}

TEST(Grid, NoRingsNoGrid) {
  const image::GreyImage grey{
      .width_px = 640, .height_px = 480, .pixels = std::vector<std::uint8_t>(640 * 480, 90)};
  LONGS_EQUAL(0, find_grids(grey, scene.target, 1).size());
}

}  // namespace biteline::calibration
