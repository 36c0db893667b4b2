// SPDX-License-Identifier: MIT
#include <CppUTest/TestHarness.h>

#include <algorithm>

#include "host/bite_line/path/layers.hpp"

namespace biteline::bite_line {
namespace {

constexpr int k_slope_rows = 41, k_slope_cols = 120, k_line_row = 20;

/// A side that goes in by 3 mm for each one up, seen but for the columns `from` to `end`.
SideField slope(int from, int end) {
  SideField field;
  field.grid = {.rows = k_slope_rows, .cols = k_slope_cols, .z_low_mm = 0, .row_mm = 0.25, .col_mm = 1};
  field.o_mm.resize(field.grid.size());
  field.seen.resize(field.grid.size());
  for (int col = 0; col < k_slope_cols; ++col) {
    for (int row = 0; row < k_slope_rows; ++row) {
      field.o_mm[field.grid.at(row, col)] = static_cast<float>(-3 * row * field.grid.row_mm);
      field.seen[field.grid.at(row, col)] = col >= from && col < end ? 0 : 1;
    }
  }
  return field;
}

/// A crease that turns by 8 degrees in the columns below `end`, by 60 elsewhere.
Crease weak_below(int end) {
  Crease line;
  line.row.assign(k_slope_cols, k_line_row);
  line.turn_rad.assign(k_slope_cols, 1.0F);
  std::fill_n(line.turn_rad.begin(), end, 0.14F);
  return line;
}

}  // namespace

TEST_GROUP(SharpAlong){};

TEST(SharpAlong, AWeakCreaseOnAFlatSlopeIsNotSharp) {
  const std::vector<float> sut = sharp_along(slope(0, 0), weak_below(60));
  CHECK_COMPARE(sut[30], <, 0.5F);
  CHECK_COMPARE(sut[90], >, 0.9F);
}

TEST(SharpAlong, WhatWasNotSeenIsNoSharperThanItsSides) {
  const std::vector<float> sut = sharp_along(slope(50, 80), weak_below(60));
  for (std::size_t col = 30; col < 80; ++col) DOUBLES_EQUAL(sut[30], sut[col], 1e-6);
  CHECK_COMPARE(sut[95], >, 0.9F);
}

TEST(SharpAlong, ASideThatWasNotSeenAtAllSaysNothing) {
  for (const float sut : sharp_along(slope(0, k_slope_cols), weak_below(60))) DOUBLES_EQUAL(1, sut, 1e-6);
}

}  // namespace biteline::bite_line
