// SPDX-License-Identifier: MIT
#include "host/study/wear.hpp"

#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "tests/support/errors.hpp"

namespace biteline::study {
namespace {

/// Norris, of NIST's Statistical Reference Datasets (itl.nist.gov/div898/strd): 36 readings x, y.
constexpr TrendPoint k_norris[] = {
    {0.2, 0.1},     {337.4, 338.8}, {118.2, 118.1}, {884.6, 888.0}, {10.1, 9.2},    {226.5, 228.1},
    {666.3, 668.5}, {996.3, 998.5}, {448.6, 449.1}, {777.0, 778.9}, {558.2, 559.2}, {0.4, 0.3},
    {0.6, 0.1},     {775.5, 778.1}, {666.9, 668.8}, {338.0, 339.3}, {447.5, 448.9}, {11.6, 10.8},
    {556.0, 557.7}, {228.1, 228.3}, {995.8, 998.0}, {887.6, 888.8}, {120.2, 119.6}, {0.3, 0.3},
    {0.3, 0.6},     {556.8, 557.6}, {339.1, 339.3}, {887.2, 888.0}, {999.0, 998.5}, {779.0, 778.9},
    {11.1, 10.2},   {118.3, 117.6}, {229.2, 228.9}, {669.1, 668.4}, {448.9, 449.2}, {0.5, 0.2}};

std::vector<TrendPoint> line_with_noise(int count, double slope, double noise, std::mt19937& random) {
  std::normal_distribution<double> error{0, noise};
  std::vector<TrendPoint> points;
  for (int i = 1; i <= count; ++i)
    points.push_back({.x = static_cast<double>(i), .value = 8 + slope * i + error(random)});
  return points;
}

}  // namespace

TEST_GROUP(Wear){};

TEST(Wear, TheTrendIsNistsCertifiedOne) {
  const Trend trend = *trend_of(k_norris);
  DOUBLES_EQUAL(-0.262323073774029, trend.intercept, 1e-11);
  DOUBLES_EQUAL(1.00211681802045, trend.slope, 1e-13);
  DOUBLES_EQUAL(0.232818234301152, trend.intercept_error, 1e-12);
  DOUBLES_EQUAL(0.429796848199937e-3, trend.slope_error, 1e-15);
  DOUBLES_EQUAL(0.884796396144373, trend.residual, 1e-12);
  CHECK(trend.sure());
}

TEST(Wear, StudentsTIsThatOfTables) {
  DOUBLES_EQUAL(12.706, student_95(1), 5e-4);
  DOUBLES_EQUAL(2.228, student_95(10), 5e-4);
  DOUBLES_EQUAL(2.042, student_95(30), 5e-4);
  DOUBLES_EQUAL(1.984, student_95(100), 5e-4);
}

TEST(Wear, TheLimitIsReachedWhereALineWithoutNoiseReachesIt) {
  std::vector<TrendPoint> points;
  for (int i = 1; i <= 10; ++i) points.push_back({.x = static_cast<double>(i), .value = 8 - 0.01 * i});
  const auto crossing = crossing_of(*trend_of(points), {.low = 7, .high = 9});
  CHECK(crossing.has_value());
  DOUBLES_EQUAL(7, crossing->limit, 0);
  DOUBLES_EQUAL(100, crossing->likely, 1e-6);
  // The other way round it is the other limit.
  for (TrendPoint& point : points) point.value = 16 - point.value;
  DOUBLES_EQUAL(9, crossing_of(*trend_of(points), {.low = 7, .high = 9})->limit, 0);
}

TEST(Wear, ATrendThatMayBeChanceReachesNothing) {
  std::mt19937 random{11};
  int sure = 0;
  constexpr int k_rounds = 2000;
  for (int i = 0; i < k_rounds; ++i) {
    const Trend trend = *trend_of(line_with_noise(20, 0, 0.1, random));
    if (trend.sure()) ++sure;
    CHECK(trend.sure() == crossing_of(trend, {.low = 7, .high = 9}).has_value());
  }
  // One in twenty, within three standard deviations of a binomial.
  DOUBLES_EQUAL(0.05, static_cast<double>(sure) / k_rounds, 3 * std::sqrt(0.05 * 0.95 / k_rounds));
}

TEST(Wear, TheIntervalHoldsTheTrueCrossingInNineteenOfTwenty) {
  std::mt19937 random{12};
  constexpr int k_rounds = 2000;
  int held = 0;
  for (int i = 0; i < k_rounds; ++i) {
    // From 8 mm, 0.01 mm a shoe: 7 mm after 100.  The slope is eight of its errors: always sure.
    const auto crossing =
        crossing_of(*trend_of(line_with_noise(40, -0.01, 0.09, random)), {.low = 7, .high = 9});
    CHECK(crossing.has_value());
    CHECK(crossing->earliest < crossing->likely && crossing->likely < crossing->latest);
    if (crossing->earliest <= 100 && 100 <= crossing->latest) ++held;
  }
  DOUBLES_EQUAL(0.95, static_cast<double>(held) / k_rounds, 3 * std::sqrt(0.05 * 0.95 / k_rounds));
}

TEST(Wear, OneSeriesHasTheSameTrendWithinAsBefore) {
  const std::vector<TrendPoint> points{std::begin(k_norris), std::end(k_norris)};
  const Trend one = *trend_of(points), within = *trend_within(std::span{&points, 1});
  DOUBLES_EQUAL(one.slope, within.slope, 1e-13);
  DOUBLES_EQUAL(one.intercept, within.intercept, 1e-10);
  DOUBLES_EQUAL(one.slope_error, within.slope_error, 1e-13);
  DOUBLES_EQUAL(one.slope_u95, within.slope_u95, 1e-12);
}

/// Three series at levels of their own, which a single line would take for a trend.
TEST(Wear, SeriesAtOtherLevelsShareOneSlope) {
  std::mt19937 random{13};
  std::normal_distribution<double> error{0, 0.05};
  constexpr int k_rounds = 2000;
  constexpr double k_slope = 0.01;
  int held = 0;
  for (int round = 0; round < k_rounds; ++round) {
    std::vector<std::vector<TrendPoint>> groups(3);
    for (int i = 0; i < 24; ++i)
      groups[static_cast<std::size_t>(i / 8)].push_back(
          {.x = static_cast<double>(i), .value = -2.0 * (i / 8) + k_slope * i + error(random)});
    const Trend trend = *trend_within(groups);
    LONGS_EQUAL(24, trend.count);
    if (std::abs(trend.slope - k_slope) <= trend.slope_u95) ++held;
  }
  DOUBLES_EQUAL(0.95, static_cast<double>(held) / k_rounds, 3 * std::sqrt(0.05 * 0.95 / k_rounds));
}

TEST(Wear, ATrendWithinSeriesNeedsTwoPointsMoreThanSeries) {
  const std::vector<std::vector<TrendPoint>> groups{{{1, 2}, {2, 3}}, {}, {{3, 3}}};
  FAILS_NAMING(Errc::BadValue, "2 more than series", trend_within(groups));
  FAILS_NAMING(Errc::BadValue, "one place",
               trend_within(std::vector<std::vector<TrendPoint>>{{{1, 2}, {1, 3}, {1, 4}}}));
}

TEST(Wear, ThreePointsAtTwoPlacesAreTheLeast) {
  const TrendPoint points[] = {{1, 2}, {1, 3}, {1, 4}};
  FAILS_NAMING(Errc::BadValue, "at least 3", trend_of(std::span{points}.first(2)));
  FAILS_NAMING(Errc::BadValue, "at one place", trend_of(points));
}

}  // namespace biteline::study
