// SPDX-License-Identifier: MIT
#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <vector>

#include "host/bite_line/layers/changes.hpp"

namespace biteline::bite_line {

/// A side with a crease at row 60 all round, and another one at row 44 (4 mm lower).
TEST_GROUP(LayerChanges) {
  static constexpr int k_cols = 400;
  static constexpr int k_line = 60, k_other = 44;
  SideField field;
  std::vector<int> path = std::vector<int>(k_cols, k_line);

  void setup() override {
    field.grid = {.rows = 100, .cols = k_cols, .z_low_mm = 0, .row_mm = 0.25, .col_mm = 1.0};
    field.seen.resize(field.grid.size());
    field.turn_rad.resize(field.grid.size());
    std::fill(field.seen.begin(), field.seen.end(), std::uint8_t{1});
    std::fill(field.turn_rad.begin(), field.turn_rad.end(), 0.0F);
    for (int col = 0; col < k_cols; ++col) crease(k_line, col), crease(k_other, col);
  }
  void crease(int row, int col) {
    for (int r = row - 1; r <= row + 1; ++r) field.turn_rad[field.grid.at(r, col)] = 0.3F;
  }
  /// The path lies on the other crease from one column to another, and takes 4 columns to get there and back.
  void leave(int from, int to) {
    for (int col = from; col < to; ++col) {
      const int away = 4 * std::min({col - from, to - 1 - col, 4});
      path[static_cast<std::size_t>(col % k_cols)] = k_line - away;
    }
  }
  void hide(int from, int to) {
    for (int col = from; col < to; ++col) {
      for (int row = 0; row < field.grid.rows; ++row) {
        field.seen[field.grid.at(row, col)] = 0;
        field.turn_rad[field.grid.at(row, col)] = 0;
      }
    }
  }
  std::vector<OtherCrease> others(std::span<const Branch> branches = {}) {
    return other_creases(field, path, layer_changes(field, path, {}), {}, branches);
  }
  /// A line that falls from row 90 to row 20 from column 100 to 240, and climbs again behind it.
  static int falling(int col) {
    return col < 100 ? 90 : col < 240 ? 90 - (col - 100) / 2 : 20 + 70 * (col - 240) / 160;
  }
  /// A crease 4 mm below it that falls later, so that they meet at 240.
  static int meeting(int col) {
    return std::min(falling(col), 74 - std::max(0, 54 * (col - 100) / 140));
  }
  /// The path changes to that one at column 100.
  void change_to_meeting() {
    std::fill(field.turn_rad.begin(), field.turn_rad.end(), 0.0F);
    for (int col = 0; col < k_cols; ++col) {
      crease(falling(col), col), crease(meeting(col), col);
      const int row = std::max(meeting(col), falling(col) - 4 * std::max(0, col - 98));
      path[static_cast<std::size_t>(col)] = col < 240 ? row : falling(col);
    }
  }
  template <class Row>
  static Branch on(Row row, int from, int to, double worse) {
    Branch branch{.first_col = from, .row = {}, .worse = worse, .over_cols = static_cast<double>(to - from)};
    for (int col = from; col < to; ++col) branch.row.push_back(row(col));
    return branch;
  }
};

TEST(LayerChanges, ACourseOnOneCreaseHasNone) {
  CHECK(layer_changes(field, path, {}).empty());
  CHECK(others().empty());
}

TEST(LayerChanges, ACourseThatCrossesToAnotherCreaseAndBackIsOffBetween) {
  leave(100, 180);
  const std::vector<LayerChange> sut = layer_changes(field, path, {});
  LONGS_EQUAL(2, sut.size());
  DOUBLES_EQUAL(-4, sut[0].rise_mm, 0.5);
  DOUBLES_EQUAL(4, sut[1].rise_mm, 0.5);
  for (const OtherCrease& other : others()) {
    DOUBLES_EQUAL(102, other.first_col, 3);
    DOUBLES_EQUAL(76, other.cols, 6);
    DOUBLES_EQUAL(4, other.off_mm, 0.5);
  }
}

TEST(LayerChanges, TheShorterWayIsTheOtherCreaseAcrossTheSeam) {
  leave(360, 430);
  LONGS_EQUAL(2, others().size());
  for (const OtherCrease& other : others()) {
    DOUBLES_EQUAL(362, other.first_col, 3);
    DOUBLES_EQUAL(66, other.cols, 6);
  }
}

TEST(LayerChanges, ACreaseThatClimbsIsKept) {
  for (int col = 100; col < 136; ++col) {
    const int row = k_line + 2 * std::min(col - 100, 135 - col);
    path[static_cast<std::size_t>(col)] = row;
    crease(row, col);
  }
  CHECK(layer_changes(field, path, {}).empty());
}

TEST(LayerChanges, ABendWhereTheCreaseFadesIsNone) {
  for (int col = 0; col < k_cols; ++col) {
    const int row = 12 + 2 * std::clamp(col - 100, 0, 39);
    path[static_cast<std::size_t>(col)] = row;
    if (col < 90 || col > 110) crease(row, col);
  }
  for (const LayerChange& sut : layer_changes(field, path, {})) CHECK(sut.col < 60 || sut.col > 160);
}

TEST(LayerChanges, TheWayBackMayBeSlow) {
  leave(100, 180);
  // It comes back over 40 mm, along an edge that runs up from the one crease to the other.
  for (int col = 140; col < 180; ++col) {
    const int row = k_other + 16 * (col - 139) / 40;
    path[static_cast<std::size_t>(col)] = row;
    crease(row, col);
  }
  LONGS_EQUAL(1, layer_changes(field, path, {}).size());
  LONGS_EQUAL(1, others().size());
  DOUBLES_EQUAL(102, others().front().first_col, 3);
  DOUBLES_EQUAL(57, others().front().cols, 6);
}

TEST(LayerChanges, AFadedStretchAtTheSameHeightIsNone) {
  for (int col = 100; col < 140; ++col) {
    for (int row = 0; row < field.grid.rows; ++row) field.turn_rad[field.grid.at(row, col)] = 0;
  }
  CHECK(layer_changes(field, path, {}).empty());
}

TEST(LayerChanges, WhatWasNotSeenHidesTheOtherStep) {
  leave(100, 180);
  hide(96, 116);
  const std::vector<LayerChange> sut = layer_changes(field, path, {});
  LONGS_EQUAL(1, sut.size());
  LONGS_EQUAL(1, others().size());
  DOUBLES_EQUAL(116, others().front().first_col, 3);
  DOUBLES_EQUAL(62, others().front().cols, 6);
}

TEST(LayerChanges, WhereTwoCreasesMeetTheOneThatWasLeftTellsHowLongTheCourseIsOffIt) {
  // As read on a shoe with a wedge: a groove below its upper edge meets that edge where the wedge ends.
  change_to_meeting();
  LONGS_EQUAL(1, layer_changes(field, path, {}).size());
  // A detour beside the change, a dearer way, one of another place and one that never comes back say
  // nothing.
  const std::vector<Branch> branches{on(falling, 99, 110, 0.5), on(falling, 101, 236, 6.0),
                                     on(falling, 101, 330, 9.0), on(falling, 300, 390, 0.1),
                                     on([](int) { return 99; }, 99, 499, 0.2)};
  const std::vector<OtherCrease> sut = others(branches);
  LONGS_EQUAL(1, sut.size());
  LONGS_EQUAL(101, sut.front().first_col);
  LONGS_EQUAL(135, sut.front().cols);
  DOUBLES_EQUAL(4, sut.front().off_mm, 0.5);
}

TEST(LayerChanges, TheOneThatWasChangedToMayHaveBeenThereBefore) {
  change_to_meeting();
  const std::vector<OtherCrease> sut = others(std::vector{on(meeting, 40, 99, 6.0)});
  LONGS_EQUAL(1, sut.size());
  LONGS_EQUAL(40, sut.front().first_col);
  LONGS_EQUAL(59, sut.front().cols);
}

TEST(LayerChanges, AChangeOfWhichNothingTellsMoreMakesBothSidesUnsure) {
  change_to_meeting();
  const std::vector<OtherCrease> sut = others();
  LONGS_EQUAL(1, sut.size());
  DOUBLES_EQUAL(2, sut.front().first_col, 3);
  LONGS_EQUAL(200, sut.front().cols);
  DOUBLES_EQUAL(4, sut.front().off_mm, 0.5);
}

}  // namespace biteline::bite_line
