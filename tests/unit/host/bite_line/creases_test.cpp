// SPDX-License-Identifier: MIT
#include "host/bite_line/path/creases.hpp"

#include <CppUTest/TestHarness.h>

namespace biteline::bite_line {
namespace {

constexpr int k_wall_rows = 60, k_wall_cols = 100, k_foot_row = 20;

/// An upright wall above the path; below it `below_mm` stands out in so many rows, the lowest ones unseen.
SideField standing_on(float below_mm, int rows) {
  SideField field;
  field.grid = {.rows = k_wall_rows, .cols = k_wall_cols, .z_low_mm = 0, .row_mm = 0.25, .col_mm = 1};
  for (auto* of : {&field.o_mm, &field.turn_rad, &field.wide_turn_rad}) of->assign(field.grid.size(), 0.0F);
  field.seen.resize(field.grid.size());
  for (int col = 0; col < k_wall_cols; ++col) {
    for (int row = 0; row < k_wall_rows; ++row) {
      field.o_mm[field.grid.at(row, col)] = row < k_foot_row ? below_mm : 0;
      field.seen[field.grid.at(row, col)] = row >= k_foot_row - rows ? 1 : 0;
    }
  }
  return field;
}

double sole_share(const SideField& field) {
  return describe(field, std::vector<int>(k_wall_cols, k_foot_row), {}).sole_share;
}

}  // namespace

TEST_GROUP(Creases){};

TEST(Creases, AThinSoleShowsBelowItsLine) {
  DOUBLES_EQUAL(1, sole_share(standing_on(4, 8)), 1e-9);
}

TEST(Creases, BelowThePlateNothingShows) {
  DOUBLES_EQUAL(0, sole_share(standing_on(15, 2)), 1e-9);
}

TEST(Creases, ATableBelowAWidePlateIsNoSole) {
  DOUBLES_EQUAL(0, sole_share(standing_on(31, 20)), 1e-9);
}

}  // namespace biteline::bite_line
