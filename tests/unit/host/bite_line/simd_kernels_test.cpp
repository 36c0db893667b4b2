// SPDX-License-Identifier: MIT
// Vector loops against plain ones, for lengths that are no multiple of a vector's.
#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

#include "host/bite_line/simd_kernels.hpp"

namespace biteline::bite_line {
namespace {

constexpr std::size_t k_longest = 70;

std::vector<float> drawn(std::size_t count) {
  std::mt19937 random{11};
  std::uniform_real_distribution<float> uniform{-1.0F, 1.0F};
  std::vector<float> values(count);
  std::generate(values.begin(), values.end(), [&] { return uniform(random); });
  return values;
}

}  // namespace

TEST_GROUP(Lanes){};

TEST(Lanes, AKernelSlidesAlongRowsOfAnyLength) {
  const std::vector<float> from = drawn(k_longest + 3);
  const std::vector<float> kernel{0.25F, -0.5F, 1.0F};
  for (std::size_t size = 1; size <= k_longest; ++size) {
    std::vector<float> to(size + 1, 7.0F);
    convolve({to.data(), size}, from.data(), kernel);
    for (std::size_t i = 0; i < size; ++i)
      DOUBLES_EQUAL(0.25F * from[i] - 0.5F * from[i + 1] + from[i + 2], to[i], 1e-6);
    DOUBLES_EQUAL(7.0, to[size], 0);
  }
}

TEST(Lanes, ACirclesCurvatureIsItsOwnAlsoWhereItIsSteep) {
  constexpr double k_radius_mm = 5;
  constexpr double k_step_mm = 0.05;
  std::vector<float> circle;
  for (std::size_t i = 0; i < k_longest + 2; ++i) {
    const double z_mm = k_step_mm * static_cast<double>(i);
    circle.push_back(static_cast<float>(-std::sqrt(k_radius_mm * k_radius_mm - z_mm * z_mm)));
  }
  for (std::size_t size = 1; size <= k_longest; ++size) {
    std::vector<float> to(size + 1, 7.0F);
    curvatures({to.data(), size}, circle.data(), static_cast<float>(1 / k_step_mm));
    for (std::size_t i = 0; i < size; ++i) DOUBLES_EQUAL(1 / k_radius_mm, to[i], 1e-3);
    DOUBLES_EQUAL(7.0, to[size], 0);
  }
}

TEST(Lanes, APointLandsAtItsNearestStationAndAtItsHeightAboveTheSlopingPath) {
  const std::vector<PathGrid::Step> steps{{10, 2}, {12, -1}, {11, -1}};
  const PathGrid grid{
      .steps = steps, .rows = 8, .zero_row = 3, .station_mm = 0.5F, .per_row = 1, .reach_o_mm = 14};
  const std::vector<OutlinePlace> places{
      {0.25F, 1, 11},     // half-way to the next station: the path lies at 11 there
      {1.4F, 2, 11.25F},  // nearest to the first one, round the end
      {0.5F, 3, 8.4F},    // 3.6 below the path: under the lowest row
      {0.5F, 3, 16.6F},   // 4.6 above it: over the highest
      {0.5F, 15, 12},     // too far out
      {-1, 0, 12},        // not on the outline
      {-2.5F, 0, 12}};
  const std::vector<Landing> expected{{1, 3, -0.25F, 1}, {0, 4, -0.1F, 2}, {-1, 0, 0, 0}, {-1, 0, 0, 0},
                                      {-1, 0, 0, 0},     {-1, 0, 0, 0},    {-1, 0, 0, 0}};
  for (std::size_t size = 1; size <= k_longest; ++size) {
    std::vector<OutlinePlace> drawn_places;
    for (std::size_t i = 0; i < size; ++i) drawn_places.push_back(places[i % places.size()]);
    std::vector<Landing> sut(size + 1, Landing{7, 7, 7, 7});
    land({sut.data(), size}, drawn_places, grid);
    for (std::size_t i = 0; i < size; ++i) {
      const Landing& here = expected[i % expected.size()];
      LONGS_EQUAL(here.station, sut[i].station);
      if (here.station < 0) continue;
      LONGS_EQUAL(here.row, sut[i].row);
      DOUBLES_EQUAL(here.s_mm, sut[i].s_mm, 1e-6);
      DOUBLES_EQUAL(here.o_mm, sut[i].o_mm, 0);
    }
    LONGS_EQUAL(7, sut[size].station);
  }
}

TEST(Lanes, AColumnsStepIsTheCheapestAndTheFirstOfEquals) {
  for (const int reach : {1, 2, 3, 4, 5}) {
    std::vector<float> penalty;
    for (int d = -reach; d <= reach; ++d) penalty.push_back(0.25F * static_cast<float>(d * d));
    for (std::size_t size = 1; size <= k_longest; ++size) {
      // In quarters, so that many ways cost the same.
      std::vector<float> before = drawn(size + 2 * static_cast<std::size_t>(reach));
      for (float& value : before) value = std::round(4 * value) / 4;
      const std::vector<float> own = drawn(size);
      std::vector<float> total(size + 1, 7.0F);
      std::vector<std::int8_t> step(size + 1, 7);
      step_column({.before = before.data() + reach, .penalty = penalty, .own = own.data(), .most = 1.5F},
                  {total.data(), size}, step.data());
      for (std::size_t row = 0; row < size; ++row) {
        std::size_t best = 0;
        const auto cost = [&](std::size_t k) { return before[row + k] + penalty[k]; };
        for (std::size_t k = 1; k < penalty.size(); ++k) best = cost(k) < cost(best) ? k : best;
        LONGS_EQUAL(static_cast<int>(best) - reach, step[row]);
        DOUBLES_EQUAL(std::min(cost(best) + own[row], 1.5F), total[row], 0);
      }
      DOUBLES_EQUAL(7.0, total[size], 0);
      LONGS_EQUAL(7, step[size]);
    }
  }
}

}  // namespace biteline::bite_line
