// SPDX-License-Identifier: MIT
#include "host/geometry/bridge.hpp"

#include <CppUTest/TestHarness.h>

#include <cmath>
#include <numbers>

#include "host/geometry/closed_spline.hpp"

namespace biteline::geometry {

TEST_GROUP(Bridge){};

TEST(Bridge, GapsAreFoundAcrossTheSeamToo) {
  const std::vector<std::uint8_t> known{0, 0, 1, 1, 0, 1, 0};
  const std::vector<Gap> gaps = gaps_of(known);
  LONGS_EQUAL(2, gaps.size());
  LONGS_EQUAL(3, gaps[0].first);
  LONGS_EQUAL(2, gaps[0].steps);
  LONGS_EQUAL(5, gaps[1].first);
  LONGS_EQUAL(4, gaps[1].steps);
  CHECK(gaps_of(std::vector<std::uint8_t>(5, 0)).empty());
  CHECK(gaps_of(std::vector<std::uint8_t>(5, 1)).empty());
}

TEST(Bridge, IslandsInAGapAreDroppedAndShoresStay) {
  std::vector<std::uint8_t> known{1, 1, 1, 0, 0, 0, 1, 0, 0, 0, 0, 1, 1, 1, 1, 0, 1};
  std::vector<std::uint8_t> expected = known;
  expected[6] = 0;
  drop_islands(known, 0.5, 1.6);
  CHECK(expected == known);
}

TEST(Bridge, SmoothBridgeFollowsAParabolaAndAStraightOneItsChord) {
  constexpr double k_station_mm = 0.5;
  std::vector<std::uint8_t> known(100, 1);
  for (std::size_t i = 40; i < 60; ++i) known[i] = 0;
  std::vector<double> smooth(100), straight(100);
  const auto parabola = [](std::size_t i) { return 0.001 * std::pow(static_cast<double>(i) - 50, 2); };
  for (std::size_t i = 0; i < 100; ++i) smooth[i] = straight[i] = known[i] != 0 ? parabola(i) : 99.0;
  bridge_smooth(smooth, known, k_station_mm, 5.0);
  bridge_straight(straight, known, k_station_mm);
  // Slopes are those of the last 5 mm, so a little steeper than at the gap's very ends.
  DOUBLES_EQUAL(parabola(50), smooth[50], 0.06);
  DOUBLES_EQUAL(parabola(39), straight[50], 0.03);
}

TEST(Bridge, ASlopeIsReadBehindAShortGapToo) {
  // A slope of 0.1.  The last two millimetres beside the gap climb by 0.3: too short to lead.
  constexpr double k_station_mm = 0.5;
  const auto slope = [](std::size_t i) { return 0.05 * static_cast<double>(i); };
  std::vector<std::uint8_t> known(100, 1);
  std::vector<double> values(100);
  for (std::size_t i = 0; i < 100; ++i) values[i] = slope(i);
  for (std::size_t i = 36; i < 40; ++i) values[i] -= 0.1 * static_cast<double>(39 - i);
  for (std::size_t i = 34; i < 36; ++i) known[i] = 0;
  for (std::size_t i = 40; i < 80; ++i) known[i] = 0;
  bridge_smooth(values, known, k_station_mm, 10.0);
  for (std::size_t i = 40; i < 80; ++i) DOUBLES_EQUAL(slope(i), values[i], 0.4);  // 0.6 by those alone
}

TEST(Bridge, MeansOfTheEndsCarryAScatteringValueAcross) {
  std::vector<std::uint8_t> known(40, 1);
  std::vector<double> values(40);
  for (std::size_t i = 0; i < 40; ++i) values[i] = (i < 20 ? 1.0 : 3.0) + (i % 2 == 0 ? 0.5 : -0.5);
  for (std::size_t i = 15; i < 25; ++i) known[i] = 0;
  bridge_means(values, known, 0.5, 3.6);  // eight stations
  DOUBLES_EQUAL(1.0 + 2.0 * 5 / 11, values[19], 1e-9);
}

TEST(Bridge, ASquaresCornerLiesBeyondItsCircle) {
  // Radius 10, a quarter turned: the corner is 10 sqrt(2) from the centre, the chord as long.
  const double chord = 10 * std::numbers::sqrt2;
  DOUBLES_EQUAL(chord - 10, corner_beyond_arc_mm(chord, 0.5 * std::numbers::pi), 1e-9);
  DOUBLES_EQUAL(0, corner_beyond_arc_mm(chord, 0), 1e-12);
  CHECK(std::isfinite(corner_beyond_arc_mm(chord, std::numbers::pi)));
  // Two ends at right angles meet half a chord beyond the middle of it.
  DOUBLES_EQUAL(0.5 * chord, corner_beyond_chord_mm(chord, 0.5 * std::numbers::pi), 1e-9);
}

TEST(Bridge, ArcBetweenTangentsOfACircleLiesOnTheCircle) {
  constexpr double k_radius_mm = 25;
  for (const double half_rad : {0.1, 0.4, 0.8, 1.2}) {
    const auto point = [&](double a) {
      return Vec3{k_radius_mm * std::cos(a), k_radius_mm * std::sin(a), 3};
    };
    const auto way = [](double a) { return Vec3{-std::sin(a), std::cos(a), 0}; };
    const Arc sut{
        .p0 = point(-half_rad), .d0 = 7 * way(-half_rad), .p1 = point(half_rad), .d1 = 0.1 * way(half_rad)};
    DOUBLES_EQUAL(2 * half_rad, sut.turn_rad(), 1e-9);
    // The classic error of such a cubic grows with the sixth power of the angle: 0.5 % of the radius at 2.4
    // rad.
    for (const double share : {0.1, 0.3, 0.5, 0.8})
      DOUBLES_EQUAL(k_radius_mm, sut.at(share).head<2>().norm(), 0.005 * k_radius_mm);
  }
}

TEST(Bridge, SplineThroughThreeSamplesToAWaveHasMostOfItsSlope) {
  // Stitches: 3 mm apart, scanned once a millimetre, not quite evenly.
  constexpr double k_period_mm = 3.0;
  constexpr double k_turn_mm = 300.0;
  const auto wave = [](double s) { return std::sin(2 * std::numbers::pi * s / k_period_mm); };
  std::vector<ClosedSpline::Knot> knots;
  for (int i = 0; i < 300; ++i) {
    const double at = i + 0.15 * std::sin(12.9 * i) + 0.2;
    knots.push_back({at, wave(at)});
  }
  const ClosedSpline sut{knots, k_turn_mm};
  double along = 0, power = 0;
  for (double s = 0; s < k_turn_mm; s += 0.05) {
    const double slope =
        2 * std::numbers::pi / k_period_mm * std::cos(2 * std::numbers::pi * s / k_period_mm);
    along += sut.at(s).slope * slope;
    power += slope * slope;
  }
  CHECK_COMPARE(along / power, >, 0.85);
  for (const auto& knot : knots) DOUBLES_EQUAL(knot.value, sut.at(knot.at_mm).value, 1e-9);
  // Whole at the seam.
  DOUBLES_EQUAL(sut.at(0.0).value, sut.at(k_turn_mm - 1e-9).value, 1e-6);
  DOUBLES_EQUAL(sut.at(0.0).slope, sut.at(k_turn_mm - 1e-9).slope, 1e-6);
}

}  // namespace biteline::geometry
