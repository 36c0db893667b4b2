// SPDX-License-Identifier: MIT
#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <cstddef>
#include <vector>

#include "host/bite_line/place/hidden_corner.hpp"

namespace biteline::bite_line {
namespace {

constexpr std::size_t k_spaced = 800;
constexpr double k_apart_mm = 0.5;
constexpr std::size_t k_before_gap = 380, k_hidden_steps = 40;  // a gap of 20 mm

/// What a hidden corner may do to each height of a line that runs level up to the gap's middle and climbs by
/// `slope` for 40 mm from there; half a turn on it is low again.
std::vector<double> hidden_up(double slope, std::size_t first = k_before_gap) {
  std::vector<Vec2> place;
  PlacedLine line{.points = std::vector<PlacedStation>(k_spaced), .length_mm = k_spaced * k_apart_mm};
  for (std::size_t i = 0; i < k_spaced; ++i) {
    const std::size_t in = (i + k_spaced - first) % k_spaced;
    const double beyond_mm = (static_cast<double>(in) - 0.5 * k_hidden_steps) * k_apart_mm;
    place.emplace_back(static_cast<double>(i) * k_apart_mm,
                       in < k_spaced / 2 ? slope * std::clamp(beyond_mm, 0.0, 40.0) : 0);
    if (in > 0 && in < k_hidden_steps)
      line.points[i].to_visible_mm = static_cast<double>(std::min(in, k_hidden_steps - in)) * k_apart_mm;
  }
  doubt_hidden_corners(place, k_spaced * k_apart_mm, line);
  std::vector<double> up_mm;
  for (std::size_t i = 0; i < k_spaced; ++i)
    up_mm.push_back(line.points[(i + first) % k_spaced].hidden_up_mm);
  return up_mm;
}

}  // namespace

TEST_GROUP(HiddenCorner){};

TEST(HiddenCorner, HalfOfHowFarItLeadsAwayIsAStandardDeviation) {
  // Level before, 45 degrees behind; the chord goes 20 mm along and 10 up.  Straight on from its beginning is
  // 10 mm off at its end: so far away is a kink at the end, and half as far in the middle.
  const std::vector<double> up_mm = hidden_up(1);
  DOUBLES_EQUAL(5.0 / 2, up_mm[k_hidden_steps / 2], 0.02);
  // 2 mm before the end it can be 2 mm off at most.
  DOUBLES_EQUAL(2.0 / 2, up_mm[k_hidden_steps - 4], 0.02);
  DOUBLES_EQUAL(0, up_mm[k_hidden_steps], 1e-9);
  DOUBLES_EQUAL(0, up_mm[k_hidden_steps + 20], 1e-9);
}

TEST(HiddenCorner, OfALineThatRunsLevelOrStraightItIsNothing) {
  for (const double mm : hidden_up(0)) DOUBLES_EQUAL(0, mm, 1e-9);
  // A climb of 17 degrees, as a heel's.
  for (const double mm : hidden_up(0.3)) DOUBLES_EQUAL(0, mm, 1e-9);
}

TEST(HiddenCorner, AGapOverTheBeginningIsAsAnyOther) {
  const std::vector<double> inside = hidden_up(1), over = hidden_up(1, k_spaced - 10);
  for (std::size_t i = 0; i < k_spaced; ++i) DOUBLES_EQUAL(inside[i], over[i], 1e-6);
}

}  // namespace biteline::bite_line
