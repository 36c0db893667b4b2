// SPDX-License-Identifier: MIT
#include "host/second_look/shift.hpp"

#include <CppUTest/TestHarness.h>

#include <cmath>
#include <numbers>
#include <random>

namespace biteline::second_look {
namespace {

constexpr std::size_t k_rows = 200, k_cells = 250;
constexpr double k_noise_mm = 0.01;

/// A wave as slow as an arm's own, and a wall that bulges: its slope goes from -1 to 1.
double shift_mm(std::size_t row) {
  return 0.03 * std::sin(2 * std::numbers::pi * 2 * static_cast<double>(row) / k_rows);
}
double slope(std::size_t cell) {
  return 2 * static_cast<double>(cell) / k_cells - 1;
}

}  // namespace

TEST_GROUP(Shift) {
  const Zones zones{.low_cell = 100, .end_cell = 150, .below_end_cell = 85, .above_first_cell = 165};
  Change change{.across = {.low_mm = -10, .cells = k_cells}};
  Compared compared{};

  void setup() override {
    std::mt19937 random{7};
    std::normal_distribution<double> noise_mm{0, k_noise_mm};
    for (std::size_t i = 0; i < k_rows; ++i) {
      change.along_mm.push_back(static_cast<double>(i));
      const double own_mm = 0.1 * std::sin(static_cast<double>(i));  // no two rows lie at one height
      for (std::size_t j = 0; j < k_cells; ++j) {
        change.value.push_back({own_mm + shift_mm(i) * slope(j) + noise_mm(random), 0, 0});
        change.variance.push_back({1, 1, 1});
        compared.variance_ratio.push_back(1);
        compared.slope.push_back(slope(j));
      }
    }
  }
  /// What of a slope is left in a row.
  [[nodiscard]] double left_mm(std::size_t row) const {
    double sh = 0, ss = 0;
    for (std::size_t j = 0; j < k_cells; ++j) {
      sh += slope(j) * change.value[change.at(row, j)][k_height];
      ss += slope(j) * slope(j);
    }
    return sh / ss;
  }
};

/// A row's own slope is known to noise / sqrt(250 / 3) = 1.1 um (standard deviation), the mean of some 14
/// rows to a quarter of that.  A wave of 100 mm loses 3 % of its 30 um in that mean: 1 um.  With 5 of these:
/// 7 um.
TEST(Shift, AnArmThatDoesNotRepeatItsWayLeavesNoSlope) {
  take_shift_off(change, compared, zones, k_rows);
  for (std::size_t i = 0; i < k_rows; ++i) DOUBLES_EQUAL(0, left_mm(i), 0.007);
}

TEST(Shift, WhatWasWorkedStaysAsItIs) {
  for (std::size_t i = 0; i < k_rows; ++i)
    for (std::size_t j = zones.low_cell; j < zones.end_cell; ++j)
      change.value[change.at(i, j)][k_height] += 0.2;
  // A drop beside, too.
  for (std::size_t i = 90; i < 94; ++i)
    for (std::size_t j = 200; j < 230; ++j) change.value[change.at(i, j)][k_height] += 0.2;
  const Change before = change;
  take_shift_off(change, compared, zones, k_rows);
  for (std::size_t i = 0; i < k_rows; ++i)
    for (std::size_t j = 0; j < k_cells; ++j) {
      const std::size_t k = change.at(i, j);
      DOUBLES_EQUAL(before.value[k][k_height] - shift_mm(i) * slope(j), change.value[k][k_height], 0.007);
    }
}

TEST(Shift, WithoutUnworkedCellsNothingIsShifted) {
  for (Values& variance : change.variance) variance = {};
  const Change before = change;
  take_shift_off(change, compared, zones, k_rows);
  for (std::size_t k = 0; k < change.value.size(); ++k)
    DOUBLES_EQUAL(before.value[k][k_height], change.value[k][k_height], 0);
}

}  // namespace biteline::second_look
