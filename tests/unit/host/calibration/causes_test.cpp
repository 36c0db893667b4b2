// SPDX-License-Identifier: MIT
// The table of causes of a calibration folder: each is named before target, poses or lens are blamed.
#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <numbers>

#include "host/calibration/head/head_calibration.hpp"
#include "host/calibration/head/pose_file.hpp"
#include "host/calibration/head/verdict.hpp"
#include "host/calibration/rings/mosaic.hpp"
#include "host/calibration/rings/picture.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/ring_scene.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::calibration {
namespace {

namespace fs = std::filesystem;
using image::GreyImage;

/// Factors of the pixels at even and odd columns of an even row, then of an odd row.
using Pattern = std::array<double, 4>;

GreyImage seen_through(GreyImage picture, const Pattern& pattern) {
  for (int v = 0; v < picture.height_px; ++v) {
    for (int u = 0; u < picture.width_px; ++u) {
      auto& grey = picture.pixels[static_cast<std::size_t>(v * picture.width_px + u)];
      grey = static_cast<std::uint8_t>(
          std::lround(grey * pattern[static_cast<std::size_t>((u & 1) + 2 * (v & 1))]));
    }
  }
  return picture;
}

GreyImage transposed(const GreyImage& picture) {
  GreyImage out{.width_px = picture.height_px, .height_px = picture.width_px, .pixels = {}};
  for (int v = 0; v < out.height_px; ++v)
    for (int u = 0; u < out.width_px; ++u) out.pixels.push_back(picture.at(v, u));
  return out;
}

void write_pgm(const fs::path& file, const GreyImage& picture) {
  std::ofstream out(file, std::ios::binary);
  out << "P5\n" << picture.width_px << ' ' << picture.height_px << "\n255\n";
  out.write(reinterpret_cast<const char*>(picture.pixels.data()),
            static_cast<std::streamsize>(picture.pixels.size()));
}

/// 24 bits a pixel, bottom up, rows of whole words.
void write_bmp(const fs::path& file, const GreyImage& picture) {
  std::string bytes = "BM";
  const auto number = [&](std::uint32_t value, int count) {
    for (int i = 0; i < count; ++i) bytes += static_cast<char>(value >> (8 * i) & 255U);
  };
  const auto width = static_cast<std::uint32_t>(picture.width_px),
             height = static_cast<std::uint32_t>(picture.height_px);
  const std::uint32_t row = (3 * width + 3) / 4 * 4;
  number(54 + row * height, 4);
  number(0, 4);
  number(54, 4);
  number(40, 4);
  number(width, 4);
  number(height, 4);
  number(1, 2);
  number(24, 2);
  for (int i = 0; i < 6; ++i) number(0, 4);
  for (int v = picture.height_px - 1; v >= 0; --v) {
    for (const std::uint8_t grey : picture.row(v)) bytes.append(3, static_cast<char>(grey));
    bytes.append(row - 3 * width, '\0');
  }
  std::ofstream(file, std::ios::binary) << bytes;
}

/// A stripe across the columns over a bent sheet, on dark ground.
GreyImage stripe_picture(int width_px, int height_px) {
  GreyImage picture{.width_px = width_px, .height_px = height_px, .pixels = {}};
  for (int v = 0; v < height_px; ++v) {
    for (int u = 0; u < width_px; ++u) {
      const double off = std::clamp(v - (0.5 * height_px + 0.1 * std::abs(u - 0.5 * width_px)), -20.0, 20.0);
      picture.pixels.push_back(static_cast<std::uint8_t>(std::lround(6 + 190 * std::exp(-off * off / 9))));
    }
  }
  return picture;
}

SE3 flange_at(int i) {
  return geometry::make_se3(
      Eigen::Quaterniond(Eigen::AngleAxisd(0.15 * i, Vec3(std::cos(i), std::sin(i), 0.3).normalized())),
      Vec3(400 + 20 * i, 10 * i, 300));
}

}  // namespace

TEST_GROUP(Causes) {
  test::TemporaryFolder folder;
  test::RingScene scene;
  std::mt19937_64 random{3};

  void setup() override {
    scene.camera = {.fu_px = 1000, .fv_px = 995, .cu_px = 250, .cv_px = 190, .k1 = -0.1, .k2 = 0.1};
    scene.size = {.width_px = 500, .height_px = 380};
    scene.target.rows = 4;
    scene.target.cols = 5;
    folder.write("target.yaml", "rows: 4\ncols: 5\npitch: 14\nouter_diameter: 12\ninner_diameter: 6\n");
  }

  std::vector<GreyImage> pictures(int count) {
    std::vector<GreyImage> drawn;
    for (const test::ViewPlace& place : test::varied_places(count, random))
      drawn.push_back(test::draw_rings(
          scene, {test::T_cam_target_of(scene.target, place)},
          {.noise_grey = 1.5, .blur_px = 0.8, .samples = 2, .light = {}, .covered = {}}, random));
    return drawn;
  }
  void write(const char* part, const std::vector<GreyImage>& all, int first = 0) const {
    fs::create_directories(folder.path() / part);
    int number = first;
    for (const GreyImage& picture : all)
      SUCCEEDS(image::write_png(folder.path() / part / (std::to_string(number++) + ".png"), picture));
  }
  void write_poses(const std::function<SE3(int)>& flange, int count) const {
    std::vector<session::StampedPose> poses;
    for (int i = 0; i < count; ++i)
      poses.push_back({.stamp = RobotClock::time_point{Nanoseconds{i}}, .T_base_flange = flange(i)});
    SUCCEEDS(session::write_pose_table(folder.path() / "handeye/poses.csv", poses));
  }
  HeadInput with_camera() const {
    HeadInput input;
    auto camera = read_camera_folder(folder.path());
    SUCCEEDS(camera);
    input.camera = std::move(*camera);
    return input;
  }
  HeadInput with_hand_eye() const {
    HeadInput input = with_camera();
    auto hand_eye = read_hand_eye_folder(folder.path());
    SUCCEEDS(hand_eye);
    input.hand_eye = std::move(*hand_eye);
    return input;
  }
  /// The refusal of that folder, its code, words of the reason and of the step.
  static void names(const HeadInput& input, Refused code, std::initializer_list<const char*> words,
                    const char* step) {
    const HeadCalibration sut = calibrate_head(input);
    CHECK(sut.refused.has_value());
    const Refusal refusal = refusal_of(sut);
    STRCMP_EQUAL(report::refusal_row(code).name, report::refusal_row(refusal.code).name);
    for (const char* word : words) STRCMP_CONTAINS(word, refusal.reason.c_str());
    STRCMP_CONTAINS(step, report::refusal_row(refusal.code).next_step);
    CHECK(judge(sut).grade == Grade::Bad);
  }
};

TEST(Causes, RawMosaicsOfAnyOrderOfColoursAreNamed) {
  const std::vector<GreyImage> grey = pictures(4);
  for (const Pattern& pattern : {Pattern{0.62, 1, 1, 0.8}, Pattern{1, 0.55, 0.9, 1}, Pattern{0.5, 1, 1, 0.5},
                                 Pattern{1, 0.8, 1.25, 1}, Pattern{0.85, 1, 1, 0.9}}) {
    std::vector<GreyImage> raw;
    for (const GreyImage& picture : grey) raw.push_back(seen_through(picture, pattern));
    write("camera", raw);
    const HeadInput input = with_camera();
    names(input, Refused::MosaicPictures, {"camera/: 4 of 4 pictures", "raw mosaic of a colour sensor"},
          "grey (mono) format");
    LONGS_EQUAL(4, calibrate_head(input).set_aside.size());
  }
  // The step, taken.
  write("camera", grey);
  CHECK_FALSE(calibrate_head(with_camera()).refused.has_value());
}

TEST(Causes, AMosaicAmongGoodPicturesIsSetAsideByName) {
  std::vector<GreyImage> all = pictures(6);
  all[2] = seen_through(all[2], {0.6, 1, 1, 0.8});
  write("camera", all);
  const HeadCalibration sut = calibrate_head(with_camera());
  CHECK_FALSE(sut.refused.has_value());
  LONGS_EQUAL(1, sut.set_aside.size());
  STRCMP_EQUAL("camera/2.png", sut.set_aside[0].name.c_str());
  STRCMP_CONTAINS("raw mosaic", sut.set_aside[0].reason.c_str());
}

TEST(Causes, WhatIsNoMosaicIsNotTakenForOne) {
  const GreyImage rings = pictures(1)[0];
  CHECK_FALSE(is_mosaic(rings));
  CHECK_FALSE(is_mosaic(seen_through(rings, {1, 1, 0.8, 0.8})));     // fields of an interlaced camera
  CHECK_FALSE(is_mosaic(seen_through(rings, {1, 0.9, 1, 0.9})));     // two amplifiers
  CHECK_FALSE(is_mosaic(seen_through(rings, {1, 0.99, 1, 0.985})));  // a sensor as it is
  test::RingScene board = scene;
  board.target = {.rows = 5, .cols = 8, .pitch_mm = 9, .kind = TargetKind::Chessboard};
  CHECK_FALSE(is_mosaic(
      test::draw_rings(board, {test::T_cam_target_of(board.target, {.roll_rad = 0})},
                       {.noise_grey = 2, .blur_px = 0.7, .samples = 2, .light = {}, .covered = {}}, random)));
  CHECK_FALSE(is_mosaic(stripe_picture(640, 480)));
  CHECK_FALSE(is_mosaic({.width_px = 20, .height_px = 20, .pixels = std::vector<std::uint8_t>(400, 90)}));
  // Squares of two pixels, printed or in a weave.
  GreyImage weave{.width_px = 400, .height_px = 300, .pixels = {}};
  for (int i = 0; i < 400 * 300; ++i)
    weave.pixels.push_back(((i % 400) / 2 + i / 400 / 2) % 2 == 0 ? 60 : 190);
  CHECK_FALSE(is_mosaic(weave));
}

TEST(Causes, TheSearchHasAnEndInAnyPicture) {
  // What full pictures of nothing but spots cost: without bounds each of these takes minutes or hours.
  std::vector<GreyImage> spotted;
  GreyImage big = pictures(1)[0];
  big = {.width_px = 640, .height_px = 480, .pixels = {}};
  std::uniform_int_distribution<int> any{0, 255};
  for (int i = 0; i < big.width_px * big.height_px; ++i)
    big.pixels.push_back(static_cast<std::uint8_t>(any(random)));
  spotted.push_back(big);
  for (const int period_px : {2, 3, 5, 8, 11}) {
    for (int v = 0; v < big.height_px; ++v) {
      for (int u = 0; u < big.width_px; ++u) {
        const double wave =
            std::sin(2 * std::numbers::pi * u / period_px) * std::sin(2 * std::numbers::pi * v / period_px);
        big.pixels[static_cast<std::size_t>(v * big.width_px + u)] =
            static_cast<std::uint8_t>(std::lround(110 + 80 * wave + any(random) % 9));
      }
    }
    spotted.push_back(big);
  }
  test::RingScene board;
  board.target = {.rows = 5, .cols = 8, .pitch_mm = 9, .kind = TargetKind::Chessboard};
  for (const GreyImage& picture : spotted) {
    LONGS_EQUAL(0, find_grids(picture, scene.target, 1).size());
    CHECK(find_grids(picture, board.target, 2).size() <= 2);
  }
}

TEST(Causes, PartsOfDifferentSizesAreNamedWithBoth) {
  write("camera", pictures(4));
  test::RingScene half = scene;
  half.camera = {.fu_px = 500, .fv_px = 497.5, .cu_px = 125, .cv_px = 95};
  half.size = {.width_px = 250, .height_px = 190};
  std::swap(scene, half);
  write("handeye", pictures(5));
  write_poses(flange_at, 5);
  names(with_hand_eye(), Refused::PictureSizes,
        {"handeye/ has pictures of 250 x 190 px", "camera/ of 500 x 380 px"}, "same size");
}

TEST(Causes, PicturesSmallerThanTheKnownCamerasRegionAreNamed) {
  write("handeye", pictures(5));
  write("camera", pictures(3));
  write_poses(flange_at, 5);
  HeadInput input = with_hand_eye();
  input.camera.reset();
  input.known_camera = scene.camera;
  input.known_reach = {.width_px = 1000, .height_px = 760};
  names(input, Refused::PictureSizes,
        {"handeye/ has pictures of 500 x 380 px", "sensor.yaml", "1000 x 760 px"}, "same size");
  input.known_reach = {.width_px = 500, .height_px = 300};  // a region inside the pictures
  const HeadCalibration sut = calibrate_head(input);
  CHECK(sut.refused_as != Refused::PictureSizes);
}

TEST(Causes, PosesThatStandStillAreNamed) {
  write("camera", pictures(4));
  write("handeye", pictures(6));
  write_poses([](int) { return flange_at(1); }, 6);
  names(with_hand_eye(), Refused::PosesFrozen, {"every pose is the same one (6 of 6)"}, "sends new poses");
  write_poses([](int i) { return flange_at(i / 3); }, 6);  // the controller stood still twice
  names(with_hand_eye(), Refused::PosesFrozen, {"6 poses are only 2 different ones"}, "sends new poses");
  write_poses(flange_at, 6);
  CHECK(calibrate_head(with_hand_eye()).refused_as != Refused::PosesFrozen);
}

TEST(Causes, PoseFilesOfPendantsAndSpreadsheetsAreNamed) {
  const fs::path file = folder.path() / "poses.csv";
  const auto says = [&](const char* text, const char* words) {
    folder.write("poses.csv", text);
    const auto sut = read_hand_eye_poses(file);
    CHECK_FALSE_TEXT(sut.has_value(), text);
    STRCMP_CONTAINS(words, to_line(sut.error()).c_str());
    STRCMP_CONTAINS("poses.csv", to_line(sut.error()).c_str());
  };
  says("0;412.1;-33.5;310.2;1;0;0;0\n", "semicolons");
  says("0;412,1;-33,5;310,2;1;0;0;0\n", "semicolons");
  says(
      "\xef\xbb\xbf"
      "0;412,1;-33,5;310,2;1;0;0;0\n",
      "semicolons");
  says("0 412.1 -33.5 310.2 1 0 0 0\n", "blanks");
  says("0\t412.1\t-33.5\t310.2\t1\t0\t0\t0\n", "blanks");
  says("0,0.4121,-0.0335,0.3102,2.22,-2.22,0.01\n", "UR's pendant");
  says("0.4121,-0.0335,0.3102,2.22,-2.22,0.01\n", "UR's pendant");
  says("timestamp,actual_TCP_pose_0,actual_TCP_pose_1\n", "tool's tip");
  says("# view, tool position x [mm], y, z, q_w, q_x, q_y, q_z\n0,1,2,3,1,0,0,0\n", "tool's tip");
  says("# tip poses\n0,1,2,3,1,0,0,0\n", "tool's tip");
  says("0,1,2,3,1,0,0\n", "expected");
  folder.write("poses.csv",
               std::string{session::k_pose_table_head} + "# on the tooling plate\n0,1,2,3,1,0,0,0\n");
  SUCCEEDS(read_hand_eye_poses(file));
}

TEST(Causes, StripeAlongTheColumnsIsNamed) {
  write("camera", pictures(4));
  fs::create_directories(folder.path() / "laser");
  folder.write("laser/target.yaml", "rows: 4\ncols: 5\npitch: 14\nouter_diameter: 12\ninner_diameter: 6\n");
  const std::vector<GreyImage> rings = pictures(4);
  const auto take = [&](bool turned) {
    for (int i = 0; i < 4; ++i) {
      const std::string name = (folder.path() / "laser" / std::to_string(i)).string();
      SUCCEEDS(image::write_png(name + "_rings.png", rings[static_cast<std::size_t>(i)]));
      SUCCEEDS(image::write_png(name + "_laser.png",
                                turned ? transposed(stripe_picture(380, 500)) : stripe_picture(500, 380)));
    }
    HeadInput input = with_camera();
    auto laser = read_laser_folder(folder.path());
    SUCCEEDS(laser);
    input.laser = std::move(*laser);
    return input;
  };
  names(take(true), Refused::LaserAlongColumns, {"in 4 of 4 pictures the stripe runs along the columns"},
        "by 90 degrees");
  CHECK(calibrate_head(take(false)).refused_as != Refused::LaserAlongColumns);
}

TEST(Causes, OtherEndingsAreReadAndOtherNamesAreTold) {
  const fs::path camera = folder.path() / "camera";
  fs::create_directories(camera);
  const std::vector<GreyImage> all = pictures(4);
  FAILS_NAMING(Errc::FileNotFound, "pictures NN.png expected", numbered_pictures(camera, ".png"));
  fs::create_directories(camera / "left");
  for (int i = 0; i < 4; ++i)
    SUCCEEDS(
        image::write_png(camera / ("img_0" + std::to_string(i) + ".png"), all[static_cast<std::size_t>(i)]));
  folder.write("camera/notes.txt", "");
  FAILS_NAMING(Errc::FileNotFound, "4 .png (img_00.png), 1 .txt (notes.txt), 1 folders inside",
               read_camera_folder(folder.path()));
  // .BMP as a camera's own program writes them, numbered from elsewhere on.
  for (int i = 0; i < 4; ++i)
    write_bmp(camera / (std::to_string(17 + i) + (i % 2 == 0 ? ".bmp" : ".BMP")),
              all[static_cast<std::size_t>(i)]);
  auto sut = read_camera_folder(folder.path());
  SUCCEEDS(sut);
  LONGS_EQUAL(4, sut->views.size());
  STRCMP_EQUAL("camera/17.bmp", sut->views[0].name.c_str());
  CHECK_FALSE(
      calibrate_head({.camera = *sut, .laser = {}, .hand_eye = {}, .known_camera = {}, .known_reach = {}})
          .refused.has_value());
  // What most of them have, and a .png goes before.
  write_pgm(camera / "3.pgm", all[0]);
  LONGS_EQUAL(4, numbered_pictures(camera, ".png")->size());
  write("camera", all, 40);
  sut = read_camera_folder(folder.path());
  SUCCEEDS(sut);
  STRCMP_EQUAL("camera/40.png", sut->views[0].name.c_str());
}

TEST(Causes, AMountingThatNoHeadHasIsAskedAbout) {
  const auto asked = [](const Vec3& at) {
    HeadCalibration head;
    head.hand_eye.emplace();
    head.fit.converged = true;
    head.fit.state.T_flange_cam.translation() = at;
    for (const std::string& reason : judge(head).reasons)
      if (reason.find("flange, or of the tool's tip") != std::string::npos) return reason;
    return std::string{};
  };
  STRCMP_EQUAL("", asked({9, 153, 250}).c_str());
  STRCMP_EQUAL("", asked({60, -40, 15}).c_str());
  STRCMP_CONTAINS("523 mm from the flange, at x 9, y 153, z 500", asked({9, 153, 500}).c_str());
  STRCMP_CONTAINS("z -150", asked({9, 80, -150}).c_str());
}

}  // namespace biteline::calibration
