// SPDX-License-Identifier: MIT
#include "host/intake/capture/picture_judge.hpp"

#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "tests/support/ring_scene.hpp"

namespace biteline::capture {

TEST_GROUP(PictureJudge) {
  test::RingScene scene;
  std::mt19937_64 random{7};

  image::GreyImage picture(double blur_px, double light = 1) {
    return test::draw_rings(scene, {test::T_cam_target_of(scene.target, {.tilt_rad = 0.2})},
                            {.noise_grey = 1.5,
                             .blur_px = blur_px,
                             .samples = 2,
                             .sampled_at = {},
                             .light = [light](double, double) { return light; },
                             .covered = {}},
                            random);
  }
  PictureVerdict judged(const image::GreyImage& image) const {
    return judge_rings(image, calibration::find_grids(image, scene.target, 1), scene.target);
  }
};

TEST(PictureJudge, ASharpPictureIsKeptAndItsBlurIsMeasured) {
  const PictureVerdict verdict = judged(picture(0.9));
  STRCMP_EQUAL("", verdict.refused.c_str());
  CHECK(verdict.warnings.empty());
  LONGS_EQUAL(scene.target.rings(), verdict.rings);
  // The steepest two hundredths of the slopes, with noise on them: within a half of the lens's own blur.
  DOUBLES_EQUAL(0.9, verdict.blur_px, 0.45);
}

TEST(PictureJudge, BlurredDarkAndBrightAreToldApart) {
  STRCMP_CONTAINS("blurred", judged(picture(4.5)).refused.c_str());
  STRCMP_CONTAINS("too dark", judged(picture(0.9, 0.2)).refused.c_str());
  image::GreyImage bright = picture(0.9);
  for (std::uint8_t& grey : bright.pixels) grey = static_cast<std::uint8_t>(std::min(255, 2 * grey));
  STRCMP_CONTAINS("too bright", judged(bright).refused.c_str());
}

TEST(PictureJudge, ARawMosaicIsToldWhetherOrNotTheTargetIsFoundInIt) {
  for (const double red : {0.6, 0.9}) {
    image::GreyImage raw = picture(0.9);
    for (int v = 0; v < raw.height_px; v += 2) {
      for (int u = 0; u < raw.width_px; u += 2) {
        std::uint8_t& grey = raw.pixels[static_cast<std::size_t>(v * raw.width_px + u)];
        grey = static_cast<std::uint8_t>(red * grey);
      }
    }
    STRCMP_CONTAINS("raw mosaic of a colour sensor", judged(raw).refused.c_str());
  }
}

TEST(PictureJudge, ATargetThatIsNotThereIsTold) {
  image::GreyImage empty{.width_px = 800, .height_px = 600, .pixels = std::vector<std::uint8_t>(480000, 90)};
  STRCMP_CONTAINS("not seen", judged(empty).refused.c_str());
  calibration::RingTarget two = scene.target;
  two.planes = 2;
  const image::GreyImage one = picture(0.9);
  STRCMP_CONTAINS("1 of 2",
                  judge_rings(one, calibration::find_grids(one, scene.target, 1), two).refused.c_str());
}

TEST(PictureJudge, AChessboardIsJudgedAsRingsAre) {
  scene.target = {.rows = 5, .cols = 8, .pitch_mm = 9, .kind = calibration::TargetKind::Chessboard};
  const PictureVerdict sharp = judged(picture(0.9));
  STRCMP_EQUAL("", sharp.refused.c_str());
  CHECK(sharp.warnings.empty());
  LONGS_EQUAL(40, sharp.rings);
  DOUBLES_EQUAL(0.9, sharp.blur_px, 0.2);
  STRCMP_CONTAINS("a little blurred", judged(picture(2.6)).warnings.at(0).c_str());
  STRCMP_CONTAINS("blurred by", judged(picture(4.5)).refused.c_str());
  STRCMP_CONTAINS("too dark", judged(picture(0.9, 0.2)).refused.c_str());
  STRCMP_CONTAINS("too bright", judged(picture(0.9, 2.2)).refused.c_str());
  scene.target.cols = 7;
  const image::GreyImage larger = [&] {
    scene.target.cols = 8;
    image::GreyImage drawn = picture(0.9);
    scene.target.cols = 7;
    return drawn;
  }();
  STRCMP_CONTAINS("count its squares", judged(larger).refused.c_str());
}

TEST(PictureJudge, AStripeAlongTheColumnsIsToldAsSuch) {
  image::GreyImage image{.width_px = 640, .height_px = 400, .pixels = {}};
  for (int i = 0; i < 640 * 400; ++i) {
    const double off = std::clamp(i % 640 - (300 + 0.1 * (i / 640)), -20.0, 20.0);
    image.pixels.push_back(static_cast<std::uint8_t>(2 + 180 * std::exp(-off * off / 12.5)));
  }
  STRCMP_CONTAINS("runs along the columns: turn camera or laser", judge_stripe(image).refused.c_str());
}

TEST(PictureJudge, AStripeIsWantedAndNotAtFullScale) {
  image::GreyImage image{.width_px = 640, .height_px = 400, .pixels = std::vector<std::uint8_t>(256000, 2)};
  STRCMP_CONTAINS("columns only", judge_stripe(image).refused.c_str());
  const auto draw = [&](double height) {
    for (int v = 0; v < 400; ++v) {
      for (int u = 0; u < 640; ++u) {
        const double off = std::clamp(v - 200.3, -20.0, 20.0),
                     light = 2 + height * std::exp(-off * off / 12.5);
        image.pixels[static_cast<std::size_t>(v * 640 + u)] =
            static_cast<std::uint8_t>(std::min(255.0, light));
      }
    }
  };
  draw(180);
  STRCMP_EQUAL("", judge_stripe(image).refused.c_str());
  CHECK(judge_stripe(image).warnings.empty());
  draw(400);
  STRCMP_CONTAINS("at full scale", judge_stripe(image).refused.c_str());
  // Its left half in order, the right half too bright.
  for (int v = 0; v < 400; ++v) {
    for (int u = 0; u < 320; ++u) {
      std::uint8_t& grey = image.pixels[static_cast<std::size_t>(v * 640 + u)];
      grey = static_cast<std::uint8_t>(grey / 2);
    }
  }
  STRCMP_EQUAL("", judge_stripe(image).refused.c_str());
  LONGS_EQUAL(1, judge_stripe(image).warnings.size());
}

}  // namespace biteline::capture
