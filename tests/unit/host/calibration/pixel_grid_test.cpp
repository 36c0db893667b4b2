// SPDX-License-Identifier: MIT
#include "host/calibration/rings/pixel_grid.hpp"

#include <CppUTest/TestHarness.h>

#include <cmath>

#include "host/calibration/camera/plane_pose.hpp"
#include "tests/support/ring_scene.hpp"

namespace biteline::calibration {

TEST_GROUP(PixelGrid) {
  test::RingScene scene;
  std::mt19937_64 random{3};
  std::vector<SE3> T_cam_targets;

  /// A scaler that fills the picture from one with 0.87 of the columns and 0.88 of the rows, nearest pixel.
  static Vec2 nearest(const Vec2& shown_px) {
    return {std::round(0.87 * shown_px.x()) / 0.87, std::round(0.88 * shown_px.y()) / 0.88};
  }

  std::vector<std::vector<Ring>> pictures(int count, bool scaled) {
    std::vector<std::vector<Ring>> found;
    test::PictureOptions options;
    options.samples = 3;
    if (scaled) options.sampled_at = nearest;
    for (const test::ViewPlace& place : test::varied_places(count, random)) {
      T_cam_targets.push_back(test::T_cam_target_of(scene.target, place));
      found.push_back(find_rings(test::draw_rings(scene, {T_cam_targets.back()}, options, random)));
    }
    return found;
  }

  /// RMS distance of the rings' centres from the truth, as moved and turned as suits each picture best.
  double centres_rms_px(const std::vector<std::vector<Ring>>& found) const {
    double sum = 0, count = 0;
    for (std::size_t i = 0; i < found.size(); ++i) {
      std::vector<CentreObservation> centres;
      for (const Ring& ring : found[i]) {
        CentreObservation best;
        double nearest_px = 1e9;
        for (int place = 0; place < scene.target.rings(); ++place) {
          const Vec3 target = scene.target.ring_target(place / scene.target.cols, place % scene.target.cols);
          const double px = (scene.camera.project(T_cam_targets[i] * target) - ring.centre_px).norm();
          if (px >= nearest_px) continue;
          nearest_px = px;
          best = {.point_target = target, .pixel_px = ring.centre_px};
        }
        centres.push_back(best);
      }
      const auto pose = fit_plane_pose(scene.camera, centres);
      CHECK(pose.has_value());
      sum += pose->rms_px * pose->rms_px * static_cast<double>(centres.size());
      count += static_cast<double>(centres.size());
    }
    return std::sqrt(sum / count);
  }
};

TEST(PixelGrid, ScaledPicturesAreToldAndCentresFreed) {
  const auto found = pictures(3, true);
  const PixelGrid sut = find_pixel_grid(found);
  CHECK(sut.uneven());
  // Even over +- half a source pixel, 1.14 px: 0.33 px, of which blur and the few pictures leave three
  // quarters.
  DOUBLES_EQUAL(0.24, sut.rms_px(), 0.05);
  CHECK(sut.explained_ratio() > 0.5);
  std::vector<std::vector<Ring>> even = found;
  for (auto& picture : even) {
    for (Ring& ring : picture) ring = sut.corrected(ring);
  }
  CHECK_TRUE_TEXT(
      centres_rms_px(even) < 0.5 * centres_rms_px(found),
      StringFromFormat("%.4f px of %.4f", centres_rms_px(even), centres_rms_px(found)).asCharString());
}

TEST(PixelGrid, EvenPicturesAreLeftAlone) {
  const auto found = pictures(2, false);
  const PixelGrid sut = find_pixel_grid(found);
  CHECK_FALSE(sut.uneven());
  CHECK(sut.explained_ratio() < 0.05);
  const Ring& ring = found[0][0];
  DOUBLES_EQUAL(0.0, (sut.corrected(ring).centre_px - ring.centre_px).norm(), 0);
}

TEST(PixelGrid, OnePictureTellsNothing) {
  CHECK_FALSE(find_pixel_grid(pictures(1, true)).uneven());
}

}  // namespace biteline::calibration
