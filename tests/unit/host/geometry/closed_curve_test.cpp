// SPDX-License-Identifier: MIT
#include "host/geometry/closed_curve.hpp"

#include <CppUTest/TestHarness.h>

#include <numbers>
#include <random>

#include "common/geometry/se3.hpp"
#include "host/geometry/robust.hpp"
#include "host/geometry/strays.hpp"

namespace biteline::geometry {

TEST_GROUP(ClosedCurve){};

TEST(ClosedCurve, LengthCountsTheWayBackToTheFirstPoint) {
  const std::vector<Vec2> square{{0, 0}, {3, 0}, {3, 3}, {0, 3}};
  const ArcLength sut{square.size(), [&](std::size_t i) { return square[i]; }};
  DOUBLES_EQUAL(12, sut.total_mm(), 1e-12);
  const OnCurve last = sut.at(10.5);
  LONGS_EQUAL(3, last.before);
  LONGS_EQUAL(0, last.after);
  const Vec2 p = last.between<Vec2>(square[last.before], square[last.after]);
  DOUBLES_EQUAL(0, p.x(), 1e-12);
  DOUBLES_EQUAL(1.5, p.y(), 1e-12);
}

TEST(ClosedCurve, EvenPlacesAreEvenHoweverUnevenThePointsAre) {
  std::mt19937 random{4};
  std::uniform_real_distribution<double> uniform{0, 2 * std::numbers::pi};
  std::vector<double> angles(4000);
  for (double& a : angles) a = uniform(random);
  angles[17] = angles[16];  // two points at one place
  std::sort(angles.begin(), angles.end());
  const auto point = [&](std::size_t i) { return Vec2{50 * std::cos(angles[i]), 50 * std::sin(angles[i])}; };
  const ArcLength sut{angles.size(), point};
  const std::size_t count = sut.count_for(2.0);
  LONGS_EQUAL(157, count);  // of 314.16 mm
  const auto at = [&](std::size_t k) {
    const OnCurve place = sut.even(k % count, count);
    return place.between<Vec2>(point(place.before), point(place.after));
  };
  for (std::size_t k = 0; k < count; ++k) DOUBLES_EQUAL(2.0, (at(k + 1) - at(k)).norm(), 0.01);
  const std::vector<OnCurve> all = sut.even(count);
  LONGS_EQUAL(count, all.size());
  for (std::size_t k = 0; k < count; ++k) {
    LONGS_EQUAL(sut.even(k, count).before, all[k].before);
    LONGS_EQUAL(sut.even(k, count).after, all[k].after);
    DOUBLES_EQUAL(sut.even(k, count).share, all[k].share, 0);
  }
  LONGS_EQUAL(3, sut.count_for(1e6));
}

TEST(ClosedCurve, SmoothingKeepsTheMeanAndDampsAWaveAsAGaussianDoes) {
  constexpr int k_count = 200;
  std::vector<double> wave(k_count);
  for (int i = 0; i < k_count; ++i)
    wave[static_cast<std::size_t>(i)] = 5 + std::sin(2 * std::numbers::pi * 4 * i / k_count);
  const double sigma = 6;
  const std::vector<double> sut = smooth_closed(wave, sigma);
  const double omega = 2 * std::numbers::pi * 4 / k_count;
  const double left = std::exp(-0.5 * sigma * sigma * omega * omega);
  for (int i = 0; i < k_count; ++i)
    DOUBLES_EQUAL(5 + left * std::sin(omega * i), sut[static_cast<std::size_t>(i)], 0.002);
}

TEST(ClosedCurve, ARunningMeanCountsPartsOfAStep) {
  const std::vector<double> spike{0, 0, 0, 1, 0, 0, 0, 0};
  const std::vector<double> sut = running_mean(spike, 3.0);  // 1.5 steps to both sides
  DOUBLES_EQUAL(1.0 / 4, sut[3], 1e-12);
  DOUBLES_EQUAL(1.0 / 4, sut[2], 1e-12);
  DOUBLES_EQUAL(0.5 / 4, sut[1], 1e-12);
  DOUBLES_EQUAL(0, sut[0], 1e-12);
}

TEST(ClosedCurve, AWindowLongerThanTheDataGoesRoundMoreThanOnce) {
  const std::vector<double> few{3, 6, 9};
  for (const double value : running_mean(few, 8.0)) DOUBLES_EQUAL(6, value, 1e-12);
  for (const double value : running_median(few, 4)) DOUBLES_EQUAL(6, value, 1e-12);
  CHECK(running_mean({}, 3.0).empty());
}

TEST(ClosedCurve, ARunningMedianDropsWhatIsShorterThanHalfItsWindow) {
  const std::vector<double> bump{5, 0, 0, 2, 2, 2, 2, 0, 0, 5};
  const std::vector<double> sut = running_median(bump, 2);
  DOUBLES_EQUAL(0, sut[0], 1e-12);  // the two fives are next to each other round the end
  DOUBLES_EQUAL(0, sut[9], 1e-12);
  DOUBLES_EQUAL(2, sut[4], 1e-12);
}

TEST_GROUP(Robust){};

TEST(Robust, TheMedianHoldsAgainstAThirdOfWrongValues) {
  std::vector<double> values{1, 2, 3, 1e9, 2, 1e9, 2};
  DOUBLES_EQUAL(2, median_of(values), 1e-12);
  DOUBLES_EQUAL(1, quantile_of(std::span<double>{values}, 0.0), 1e-12);
  DOUBLES_EQUAL(1e9, quantile_of(std::span<double>{values}, 1.0), 1e-12);
}

TEST_GROUP(Strays){};

TEST(Strays, ASpikeIsFoundAcrossTheSeamAndAStepIsNot) {
  std::vector<double> values(100, 1.0);
  for (std::size_t i = 40; i < 100; ++i) values[i] = 3.0;  // a step stays
  values[0] = 9.0;
  std::vector<std::uint8_t> known(100, 1);
  known[20] = 0;
  values[20] = 50.0;
  const std::vector<std::size_t> sut = spikes_of(values, known, {.beside = 5, .most = 2.5});
  LONGS_EQUAL(1, sut.size());
  LONGS_EQUAL(0, sut[0]);
}

}  // namespace biteline::geometry
