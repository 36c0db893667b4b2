// SPDX-License-Identifier: MIT
#include "hal/sim/record/calibration_recorder.hpp"

#include <CppUTest/TestHarness.h>

#include <cmath>

#include "common/image/grey_image.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::sim {

TEST_GROUP(CalibrationRecorder) {
  test::TemporaryFolder folder;

  [[nodiscard]] image::GreyImage picture(int averaged, const char* name) const {
    CalibrationSettings settings{.camera_views = 1, .laser_views = 1, .handeye_views = 1};
    settings.averaged = averaged;
    SUCCEEDS(record_calibration(folder.path(), settings, {}));
    auto read = image::read_png(folder.path() / name);
    SUCCEEDS(read);
    return std::move(*read);
  }
};

TEST(CalibrationRecorder, MeansOfManyExposuresShowTheSameSceneWithLessNoise) {
  for (const char* name : {"camera/00.png", "laser/00_laser.png"}) {
    const image::GreyImage one = picture(1, name), ten = picture(10, name), most = picture(1000, name);
    const auto noise_grey = [&](const image::GreyImage& sut) {
      double squares = 0;
      for (std::size_t i = 0; i < sut.pixels.size(); ++i)
        squares += std::pow(static_cast<double>(sut.pixels[i]) - most.pixels[i], 2);
      return std::sqrt(squares / static_cast<double>(sut.pixels.size()));
    };
    // Up to whole greys of rounding and the stripe's speckle, which no average takes away.
    CHECK_COMPARE(noise_grey(ten), <, 0.6 * noise_grey(one));
    CHECK_COMPARE(noise_grey(one), <, 3.0);  // another scene would differ by tens
  }
}

}  // namespace biteline::sim
