// SPDX-License-Identifier: MIT
// A made calibration set with its truth, and the same set spoiled in the ways that happen.
#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/config/sensor_yaml.hpp"
#include "host/calibration/head/head_calibration.hpp"
#include "host/calibration/rings/picture.hpp"
#include "tests/support/shared_data.hpp"

namespace biteline::calibration {

namespace {

constexpr double k_degree = std::numbers::pi / 180;

/// The set is searched for rings once for all tests.
const HeadInput& head21(const std::filesystem::path& folder) {
  static const HeadInput input = [&] {
    HeadInput read;
    read.camera = *read_camera_folder(folder);
    read.laser = *read_laser_folder(folder);
    read.hand_eye = *read_hand_eye_folder(folder);
    return read;
  }();
  return input;
}

image::GreyImage flipped(const image::GreyImage& picture) {
  image::GreyImage result = picture;
  for (int v = 0; v < picture.height_px; ++v) {
    const auto row = result.pixels.begin() + static_cast<std::ptrdiff_t>(v) * picture.width_px;
    std::reverse(row, row + picture.width_px);
  }
  return result;
}

}  // namespace

TEST_GROUP(CalibHead){void check_refused(const HeadInput& input, const char* word){
    const HeadCalibration result = calibrate_head(input);
CHECK(result.refused.has_value());
CHECK(error_row(result.refused->code).exit_status == ExitStatus::Refused);
STRCMP_CONTAINS(word, result.refused->where.c_str());
}  // namespace biteline::calibration
void check_named(const HeadInput& input, const char* name) {
  const HeadCalibration result = calibrate_head(input);
  CHECK_TRUE_TEXT(!result.refused, result.refused ? to_line(*result.refused).c_str() : "");
  LONGS_EQUAL(1, result.set_aside.size());
  STRCMP_EQUAL(name, result.set_aside[0].name.c_str());
}
}
;

TEST(CalibHead, MeetsItsBarsAgainstTheTruth) {
  BITELINE_SHARED_DATA_OR_SKIP(folder, "calib/head21");
  const auto truth = config::read_sensor_yaml(folder / "truth/sensor.yaml");
  const HeadCalibration result = calibrate_head(head21(folder));
  CHECK_TRUE_TEXT(!result.refused, result.refused ? to_line(*result.refused).c_str() : "");
  LONGS_EQUAL(0, result.set_aside.size());
  const HeadFit& fit = result.fit;
  CHECK(fit.rms_px <= 0.05);
  DOUBLES_EQUAL(1.0, fit.state.camera.fu_px / truth->camera.fu_px, 5e-4);
  DOUBLES_EQUAL(1.0, fit.state.camera.fv_px / truth->camera.fv_px, 5e-4);

  // The set's robot noise leaves 0.027, 0.026 and 0.033 mm (one standard deviation per axis); 3 of these.
  const Twist sigma = fit.mounting_sigma();
  const Twist error = geometry::log_se3(truth->T_flange_cam.inverse() * fit.state.T_flange_cam);
  for (int i = 0; i < 6; ++i) CHECK(std::abs(error[i]) < 3 * sigma[i]);
  CHECK(error.head<3>().norm() < 0.08);
  CHECK(error.tail<3>().norm() < 0.010 * k_degree);

  // A point anywhere in the working region, in the camera's own frame.
  double sum_mm2 = 0, count = 0;
  for (int u = 50; u < 1600; u += 50) {
    for (int v = 470; v < 780; v += 20) {
      const Vec3 ours = geometry::triangulate(fit.state.camera, fit.state.plane, Vec2(u, v));
      const Vec3 theirs = geometry::triangulate(truth->camera, truth->laser_plane, Vec2(u, v));
      sum_mm2 += (ours - theirs).squaredNorm();
      count += 1;
    }
  }
  const double rms_mm = std::sqrt(sum_mm2 / count);
  CHECK_TRUE_TEXT(rms_mm <= 0.010, StringFromFormat("%.4f mm", rms_mm).asCharString());
}

TEST(CalibHead, UnevenGridOfItsPicturesIsSeen) {
  // Its lit pictures were sampled: columns and rows are up to 0.4 px off, alike in every picture.
  BITELINE_SHARED_DATA_OR_SKIP(folder, "calib/head21");
  const HeadCalibration result = calibrate_head(head21(folder));
  CHECK(result.pixel_grid.uneven());
  CHECK(result.pixel_grid.explained_ratio() > 0.9);
  CHECK(result.fit.rms_px < 0.010);
}

TEST(CalibHead, PoseRowsExchangedAreNamed) {
  BITELINE_SHARED_DATA_OR_SKIP(folder, "calib/head21");
  HeadInput input = head21(folder);
  std::swap(input.hand_eye->views[3].T_base_flange, input.hand_eye->views[8].T_base_flange);
  const HeadCalibration result = calibrate_head(input);
  CHECK(!result.refused);
  LONGS_EQUAL(2, result.set_aside.size());
  STRCMP_EQUAL("handeye/03.png", result.set_aside[0].name.c_str());
  STRCMP_EQUAL("handeye/08.png", result.set_aside[1].name.c_str());
}

TEST(CalibHead, MetresAreRefused) {
  BITELINE_SHARED_DATA_OR_SKIP(folder, "calib/head21");
  HeadInput input = head21(folder);
  for (ArmPicture& picture : input.hand_eye->views) picture.T_base_flange.translation() /= 1000;
  check_refused(input, "metres");
}

TEST(CalibHead, TwoArmViewsAreRefused) {
  BITELINE_SHARED_DATA_OR_SKIP(folder, "calib/head21");
  HeadInput input = head21(folder);
  input.hand_eye->views.resize(2);
  check_refused(input, "at least 3");
}

TEST(CalibHead, TwoCameraViewsAreRefused) {
  BITELINE_SHARED_DATA_OR_SKIP(folder, "calib/head21");
  HeadInput input = head21(folder);
  input.camera->views.resize(2);
  check_refused(input, "at least 3");
}

TEST(CalibHead, LaserPictureWithoutStripeIsNamed) {
  BITELINE_SHARED_DATA_OR_SKIP(folder, "calib/head21");
  HeadInput input = head21(folder);
  input.laser->places[3].stripe.clear();
  check_named(input, "laser/03_rings.png");
}

TEST(CalibHead, MirroredArmPicturesAreRefused) {
  BITELINE_SHARED_DATA_OR_SKIP(folder, "calib/head21");
  HeadInput input = head21(folder);
  input.laser.reset();
  for (ArmPicture& picture : input.hand_eye->views) {
    const auto grids =
        find_grids(flipped(*read_picture(folder / picture.view.name)), input.hand_eye->target, 1);
    LONGS_EQUAL(1, grids.size());
    picture.view = make_plane_view(picture.view.name, grids[0], input.hand_eye->target);
  }
  check_refused(input, "mirror");
}

TEST(CalibHead, MirroredLaserPicturesAreRefused) {
  // Consistent among themselves; only the principal point, 10 px off the middle, tells them from the
  // camera's.
  BITELINE_SHARED_DATA_OR_SKIP(folder, "calib/head21");
  HeadInput input = head21(folder);
  for (LaserPictures& place : input.laser->places) {
    const image::GreyImage picture = flipped(*read_picture(folder / place.name));
    place.planes.clear();
    for (const GridView& grid : find_grids(picture, input.laser->target, 2))
      place.planes.push_back(make_plane_view(place.name, grid, input.laser->target));
    for (StripePoint& p : place.stripe) p.pixel_px.x() = picture.width_px - 1 - p.pixel_px.x();
  }
  check_refused(input, "contradict");
}

TEST(CalibHead, PictureOfAnotherCameraIsNamed) {
  BITELINE_SHARED_DATA_OR_SKIP(folder, "calib/head21");
  HeadInput input = head21(folder);
  // As a lens of 8 % more focal length and another middle would have taken it.
  const auto other = [](Vec2& pixel_px) { pixel_px = Vec2(838, 603) + 1.08 * (pixel_px - Vec2(813, 618)); };
  PlaneView& view = input.hand_eye->views[5].view;
  for (CentreObservation& c : view.centres) other(c.pixel_px);
  for (GridRing& ring : view.grid.rings) {
    for (Vec2& p : ring.ring.outer_edge) other(p);
    for (Vec2& p : ring.ring.inner_edge) other(p);
  }
  check_named(input, "handeye/05.png");
}

}  // namespace biteline::calibration
