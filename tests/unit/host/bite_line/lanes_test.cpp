// SPDX-License-Identifier: MIT
// Vector loops against plain ones, for lengths that are no multiple of a vector's.
#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

#include "host/bite_line/lanes.hpp"

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

TEST(Lanes, TheLargestOfSeveralSums) {
  const std::vector<float> from = drawn(4 * k_longest);
  const auto row = [&](std::size_t k) { return from.data() + k * k_longest; };
  const std::vector<Tap> taps{{row(0), 0.5F}, {row(1), 1.0F}, {row(2), 1.0F}, {row(3), -1.0F}};
  for (std::size_t size = 1; size <= k_longest; ++size) {
    std::vector<float> to(size + 1, 7.0F);
    most_of_sums({to.data(), size}, taps, 2);
    for (std::size_t i = 0; i < size; ++i) {
      const float first = 0.5F * row(0)[i] + row(1)[i];
      const float second = row(2)[i] - row(3)[i];
      DOUBLES_EQUAL(std::max({0.0F, first, second}), to[i], 1e-6);
    }
    DOUBLES_EQUAL(7.0, to[size], 0);
  }
}

}  // namespace biteline::bite_line
