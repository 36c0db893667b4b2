// SPDX-License-Identifier: MIT
// Real photographs of a ring target: hand-held, glare, blur, rings of 9 to 30 px.
#include <CppUTest/TestHarness.h>

#include "host/calibration/rings/grid.hpp"
#include "host/calibration/rings/picture.hpp"
#include "tests/support/shared_data.hpp"

namespace biteline::calibration {

TEST_GROUP(CalibRings){};

TEST(CalibRings, AllTwelveRingsInEveryPhotograph) {
  BITELINE_SHARED_DATA_OR_SKIP(folder, "real-calib/rings_joshjo");
  // Not told with the pictures: pitch to diameters as measured in them.
  const RingTarget target{
      .rows = 4, .cols = 3, .pitch_mm = 30, .outer_diameter_mm = 20, .inner_diameter_mm = 10};
  int pictures = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".png") continue;
    ++pictures;
    const auto picture = read_picture(entry.path());
    CHECK(picture.has_value());
    const auto views = find_grids(*picture, target, 1);
    LONGS_EQUAL_TEXT(1, views.size(), entry.path().filename().c_str());
    LONGS_EQUAL_TEXT(12, views[0].rings.size(), entry.path().filename().c_str());
  }
  CHECK(pictures >= 10);
}

}  // namespace biteline::calibration
