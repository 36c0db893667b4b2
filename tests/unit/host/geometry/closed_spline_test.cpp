// SPDX-License-Identifier: MIT
#include "host/geometry/closed_spline.hpp"

#include <CppUTest/TestHarness.h>

#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

namespace biteline::geometry {

TEST_GROUP(ClosedSpline){};

TEST(ClosedSpline, SamplesAllAlongAreThoseAtTheirPlaces) {
  constexpr double k_turn_mm = 100;
  std::vector<ClosedSpline::Knot> knots;
  for (double at_mm = 3; at_mm < k_turn_mm; at_mm += 7)  // places before the first knot and behind the last
    knots.push_back({at_mm, std::sin(2 * std::numbers::pi * at_mm / k_turn_mm)});
  const ClosedSpline sut{knots, k_turn_mm};
  const auto all = sut.every(0.5, 200);
  LONGS_EQUAL(200, all.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    const double place_mm = 0.5 * static_cast<double>(i);
    const ClosedSpline::Sample one = sut.at(place_mm);
    DOUBLES_EQUAL(one.value, all[i].value, 0);
    DOUBLES_EQUAL(one.slope, all[i].slope, 0);
    DOUBLES_EQUAL(one.interval_mm, all[i].interval_mm, 0);
    DOUBLES_EQUAL(std::sin(2 * std::numbers::pi * place_mm / k_turn_mm), all[i].value, 0.01);
  }
}

}  // namespace biteline::geometry
