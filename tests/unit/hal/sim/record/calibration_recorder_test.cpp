// SPDX-License-Identifier: MIT
#include "hal/sim/record/calibration_recorder.hpp"

#include <CppUTest/TestHarness.h>

#include <array>
#include <cmath>
#include <memory>

#include "common/image/grey_image.hpp"
#include "common/stripe/peak_extractor.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::sim {

TEST_GROUP(CalibrationRecorder) {
  test::TemporaryFolder folder;

  /// Camera and laser pictures of the same scene.
  [[nodiscard]] std::array<image::GreyImage, 2> pictures(int averaged) const {
    CalibrationSettings settings;
    settings.camera_views = settings.laser_views = settings.handeye_views = 1;
    settings.averaged = averaged;
    SUCCEEDS(record_calibration(folder.path(), settings, {}));
    return {*image::read_png(folder.path() / "camera/00.png"),
            *image::read_png(folder.path() / "laser/00_laser.png")};
  }
};

TEST(CalibrationRecorder, MeansOfManyExposuresShowTheSameSceneWithLessNoise) {
  const auto one = pictures(1), ten = pictures(10), most = pictures(1000);
  for (std::size_t kind = 0; kind < one.size(); ++kind) {
    const auto noise_grey = [&](const image::GreyImage& sut) {
      double squares = 0;
      for (std::size_t i = 0; i < sut.pixels.size(); ++i)
        squares += std::pow(static_cast<double>(sut.pixels[i]) - most[kind].pixels[i], 2);
      return std::sqrt(squares / static_cast<double>(sut.pixels.size()));
    };
    // Up to whole greys of rounding and the stripe's speckle, which no average takes away.
    CHECK_COMPARE(noise_grey(ten[kind]), <, 0.6 * noise_grey(one[kind]));
    CHECK_COMPARE(noise_grey(one[kind]), <, 3.0);  // another scene would differ by tens
  }
}

TEST(CalibrationRecorder, LaserPicturesHaveTheSpeckleOfTheLightThatWasChosen) {
  const auto contrast_of = [&](const HeadLight& light) {
    CalibrationSettings settings;
    settings.camera_views = settings.laser_views = settings.handeye_views = 1;
    settings.light = light;
    SUCCEEDS(record_calibration(folder.path(), settings, {}));
    const image::GreyImage picture = *image::read_png(folder.path() / "laser/00_laser.png");
    auto extractor = stripe::PeakExtractor::create({}, picture.width_px, picture.height_px);
    SUCCEEDS(extractor);
    const auto peaks = std::make_unique<stripe::Peaks>();
    extractor->rt_extract(
        {.pixels = picture.pixels.data(), .stride_bytes = static_cast<std::size_t>(picture.width_px)},
        *peaks);
    CHECK(peaks->speckle.measured);
    return static_cast<double>(peaks->speckle.contrast);
  };
  // White paper keeps none of the polarisation; the contrast is measured to 15 %.  At f/2.8: with larger
  // contrasts the bright grains of so bright a stripe are at full scale, and it reads low.
  constexpr double k_f_number = 2.8;
  const double expected = optics::polarised_contrast(0) *
                          optics::pixel_contrast({.f_number = k_f_number, .magnification = 0.0638});
  DOUBLES_EQUAL(expected, contrast_of({.f_number = k_f_number}), 0.15 * expected);
  CHECK_COMPARE(contrast_of({.coherent = false}), <, 0.06);
}

}  // namespace biteline::sim
