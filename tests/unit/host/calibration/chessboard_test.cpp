// SPDX-License-Identifier: MIT
#include "host/calibration/chess/chessboard.hpp"

#include <CppUTest/TestHarness.h>

#include <cmath>
#include <numbers>

#include "host/calibration/camera/camera_calibration.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/ring_scene.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::calibration {

TEST_GROUP(Chessboard) {
  std::mt19937_64 random{11};
  test::RingScene scene;
  test::PictureOptions options;

  static constexpr double k_degree = std::numbers::pi / 180;

  void setup() override {
    // 6 x 9 squares of 9 mm: one side even, one odd.
    scene.camera = {.fu_px = 1000, .fv_px = 995, .cu_px = 283, .cv_px = 206, .k1 = -0.11, .k2 = 0.14};
    scene.size = {.width_px = 560, .height_px = 420};
    scene.target = {.rows = 5, .cols = 8, .pitch_mm = 9, .kind = TargetKind::Chessboard};
    options.samples = 5;
  }

  std::vector<GridView> boards_in(const std::vector<SE3>& T_cam_targets, int count = 1) {
    return find_grids(test::draw_rings(scene, T_cam_targets, options, random), scene.target, count);
  }

  /// Largest and RMS distance of the corners from where the truth puts them, under the best of the readings.
  struct Off {
    double worst_px{1e9}, rms_px{1e9};
  };
  Off off(const GridView& view, const SE3& T_cam_target) const {
    Off best;
    for (const Reading& reading : view.readings) {
      Off here{.worst_px = 0, .rms_px = 0};
      for (const GridRing& corner : view.rings) {
        const Vec3 place = reading.T_this_other.inverse() * scene.target.ring_target(corner.row, corner.col);
        const double off_px = (scene.camera.project(T_cam_target * place) - corner.ring.centre_px).norm();
        here.worst_px = std::max(here.worst_px, off_px);
        here.rms_px += off_px * off_px / static_cast<double>(view.rings.size());
      }
      here.rms_px = std::sqrt(here.rms_px);
      if (here.worst_px < best.worst_px) best = here;
    }
    return best;
  }
  void check_worst(const GridView& view, const SE3& T_cam_target, double tolerance_px) const {
    const double worst_px = off(view, T_cam_target).worst_px;
    CHECK_TRUE_TEXT(worst_px < tolerance_px,
                    StringFromFormat("worst corner %.3f px off", worst_px).asCharString());
  }
};

TEST(Chessboard, OddByEvenSquaresAreReadOneWayUnderAnyTurnAndTilt) {
  for (const int roll : {0, 45, 135, 250}) {
    const SE3 T = test::T_cam_target_of(scene.target, {.distance_mm = 300,
                                                       .roll_rad = roll * k_degree,
                                                       .tilt_rad = (roll < 100 ? 0.2 : 0.7),
                                                       .tilt_axis_rad = 0.7});
    const auto views = boards_in({T});
    LONGS_EQUAL(1, views.size());
    LONGS_EQUAL(0, views[0].missing);
    LONGS_EQUAL(1, views[0].readings.size());
    check_worst(views[0], T, 0.1);
  }
}

TEST(Chessboard, EvenByEvenSquaresHaveTwoReadingsAndASquareBoardToo) {
  for (const int cols : {7, 5}) {  // corners: 8 and 6 squares
    scene.target.cols = cols;
    const SE3 T = test::T_cam_target_of(scene.target, {.roll_rad = 2.1, .tilt_rad = 0.4});
    const auto views = boards_in({T});
    LONGS_EQUAL(1, views.size());
    LONGS_EQUAL(2, views[0].readings.size());
    check_worst(views[0], T, 0.1);
  }
}

TEST(Chessboard, ABoardThatBeginsWithWhiteIsToldAndReadSo) {
  scene.target.first_is_white = true;
  const SE3 T = test::T_cam_target_of(scene.target, {.roll_rad = 0.4, .tilt_rad = 0.4});
  const auto views = boards_in({T});
  LONGS_EQUAL(1, views.size());
  LONGS_EQUAL(1, views[0].readings.size());
  check_worst(views[0], T, 0.1);
}

TEST(Chessboard, AColumnBeyondThePictureLeavesTheReadingsOfTheRightColours) {
  // A column less can lie at two places, and half a turn doubles them; colours leave two of the four.
  const SE3 T = test::T_cam_target_of(scene.target, {.distance_mm = 190, .shift_mm = Vec2(26, 0)});
  const auto views = boards_in({T});
  LONGS_EQUAL(1, views.size());
  LONGS_EQUAL(5, views[0].missing);
  LONGS_EQUAL(2, views[0].readings.size());
  check_worst(views[0], T, 0.1);
}

TEST(Chessboard, UnevenLightBlurAndACoverCostTheCoveredCornersOnly) {
  const SE3 T = test::T_cam_target_of(scene.target, {.roll_rad = 0.5, .tilt_rad = 0.7, .tilt_axis_rad = 0.4});
  options.light = [](double u, double v) { return 0.35 + 0.9 * u * (1 - 0.4 * v); };
  options.blur_px = 1.5;
  const Vec2 covered = scene.target.ring_target(2, 3).head<2>();
  options.covered = [&](const Vec2& place) { return (place - covered).norm() < 3; };
  const auto views = boards_in({T});
  LONGS_EQUAL(1, views.size());
  LONGS_EQUAL(1, views[0].missing);
  check_worst(views[0], T, 0.15);
}

TEST(Chessboard, CornersAreWhereTheyAreToAHundredthOfAPixel) {
  options.noise_grey = 0;
  options.samples = 8;
  for (const double roll_deg : {0.0, 17.0, 45.0}) {
    const SE3 T = test::T_cam_target_of(
        scene.target, {.roll_rad = roll_deg * k_degree, .tilt_rad = 0.5, .tilt_axis_rad = 1});
    const auto views = boards_in({T});
    LONGS_EQUAL(1, views.size());
    const Off without_noise = off(views[0], T);
    CHECK_TRUE_TEXT(without_noise.rms_px < 0.01,
                    StringFromFormat("%.0f deg: %.4f px RMS", roll_deg, without_noise.rms_px).asCharString());
    DOUBLES_EQUAL(options.blur_px, views[0].rings[7].ring.blur_px, 0.15);  // and the pixel's own 0.29
  }
}

TEST(Chessboard, TwoPlanesOfACornerAreKeptApart) {
  scene.target = {.rows = 5, .cols = 4, .pitch_mm = 9, .kind = TargetKind::Chessboard};
  SE3 T_left = SE3::Identity(), T_right = SE3::Identity();
  T_left.linear() = Eigen::AngleAxisd(0.8, Vec3::UnitY()).toRotationMatrix();
  T_right.linear() = Eigen::AngleAxisd(-0.77, Vec3::UnitY()).toRotationMatrix();
  T_left.translation() = Vec3(0, -20, 250) - T_left.linear() * Vec3(45, 0, 0);
  T_right.translation() = Vec3(0, -20, 250) + T_right.linear() * Vec3(18, 0, 0);
  const auto views = boards_in({T_left, T_right}, 2);
  LONGS_EQUAL(2, views.size());
  LONGS_EQUAL(0, views[0].missing + views[1].missing);
  const bool left_first = views[0].rings[0].ring.centre_px.x() < views[1].rings[0].ring.centre_px.x();
  check_worst(views[0], left_first ? T_left : T_right, 0.1);
  check_worst(views[1], left_first ? T_right : T_left, 0.1);
}

TEST(Chessboard, MoreSquaresThanToldAreNotTakenForAPart) {
  const SE3 T = test::T_cam_target_of(scene.target, {.tilt_rad = 0.3});
  const image::GreyImage picture = test::draw_rings(scene, {T}, options, random);
  RingTarget told = scene.target;
  told.cols = scene.target.cols - 1;
  LONGS_EQUAL(0, find_grids(picture, told, 1).size());
  told.cols = scene.target.cols;
  LONGS_EQUAL(1, find_grids(picture, told, 1).size());
}

TEST(Chessboard, RingsAndEmptyPicturesAreNone) {
  test::RingScene rings;
  const SE3 T = test::T_cam_target_of(rings.target, {.tilt_rad = 0.3});
  LONGS_EQUAL(0, find_grids(test::draw_rings(rings, {T}, options, random), scene.target, 1).size());
  const image::GreyImage grey{
      .width_px = 640, .height_px = 480, .pixels = std::vector<std::uint8_t>(640 * 480, 90)};
  LONGS_EQUAL(0, find_grids(grey, scene.target, 1).size());
}

TEST(Chessboard, ACameraIsCalibratedByIt) {
  std::vector<PlaneView> views;
  options.blur_px = 1;
  for (const test::ViewPlace& place : test::varied_places(6, random)) {
    const auto boards = boards_in({test::T_cam_target_of(scene.target, place)});
    LONGS_EQUAL(1, boards.size());
    views.push_back(make_plane_view(std::to_string(views.size()), boards[0], scene.target));
  }
  const auto camera = calibrate_camera(views, scene.size);
  SUCCEEDS(camera);
  const CameraVector sigma = camera->sigma();
  DOUBLES_EQUAL(scene.camera.fu_px, camera->camera.fu_px, 4 * sigma[0]);
  DOUBLES_EQUAL(scene.camera.cu_px, camera->camera.cu_px, 4 * sigma[2]);
  DOUBLES_EQUAL(scene.camera.cv_px, camera->camera.cv_px, 4 * sigma[3]);
  CHECK(camera->rms_px < 0.05);
  CHECK(sigma[0] < 1e-3 * scene.camera.fu_px);
}

TEST(Chessboard, TargetYamlCountsSquaresAndFaultsNameTheirKey) {
  const test::TemporaryFolder folder;
  const auto read = [&](const char* text) { return read_target(folder.write("target.yaml", text)); };
  const auto board = read("kind: chessboard\nsquare_rows: 6\nsquare_cols: 9\npitch: 9.02\n");
  SUCCEEDS(board);
  LONGS_EQUAL(5, board->rows);
  LONGS_EQUAL(8, board->cols);
  CHECK(board->chessboard() && !board->first_is_white);
  const auto told = [&](const char* text) {
    const auto target = read(text);
    return target ? std::string() : std::string(target.error().where.view());
  };
  STRCMP_CONTAINS("square_cols", told("kind: chessboard\nsquare_rows: 6\npitch: 9\n").c_str());
  STRCMP_CONTAINS("rows",
                  told("kind: chessboard\nsquare_rows: 6\nsquare_cols: 9\nrows: 5\npitch: 9\n").c_str());
  STRCMP_CONTAINS("chess", told("kind: chess\nrows: 4\ncols: 7\npitch: 9\n").c_str());
}

}  // namespace biteline::calibration
