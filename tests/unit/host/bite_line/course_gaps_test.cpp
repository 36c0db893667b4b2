// SPDX-License-Identifier: MIT
#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "host/bite_line/level/course_gaps.hpp"

namespace biteline::bite_line {
namespace {

constexpr SideGrid k_columns_of_1_mm{.rows = 100, .cols = 300, .z_low_mm = 0, .row_mm = 0.5, .col_mm = 1};

/// A course that climbs by 0.1, up to a third of the way round and down again, and lies `step_mm` higher from
/// the column 50 up to the 80th.
Crease stepped(double step_mm) {
  Crease line;
  for (int col = 0; col < k_columns_of_1_mm.cols; ++col) {
    const double climb_mm = 0.1 * std::min(col, (k_columns_of_1_mm.cols - col) / 2);
    line.row.push_back((20 + climb_mm + (col >= 50 && col < 80 ? step_mm : 0)) / k_columns_of_1_mm.row_mm);
  }
  line.visible.assign(line.row.size(), 1);
  line.turn_rad.assign(line.row.size(), 0.8F);
  return line;
}

}  // namespace

TEST_GROUP(CourseGaps){};

TEST(CourseGaps, AJumpIsWhatTheSlopesOfTheEndsDoNotTell) {
  const Crease up = stepped(5), level = stepped(0);
  const CourseGap at_step{.first = 45, .cols = 10}, at_end{.first = 75, .cols = 10};
  DOUBLES_EQUAL(5, (CourseOverS{k_columns_of_1_mm, up}.jump_mm(at_step)), 0.01);
  DOUBLES_EQUAL(-5, (CourseOverS{k_columns_of_1_mm, up}.jump_mm(at_end)), 0.01);
  DOUBLES_EQUAL(0, (CourseOverS{k_columns_of_1_mm, level}.jump_mm(at_step)), 0);
  // 2 mm and less are a course's own bends.
  const Crease little = stepped(1.5);
  DOUBLES_EQUAL(0, (CourseOverS{k_columns_of_1_mm, little}.jump_mm(at_step)), 0);
}

TEST(CourseGaps, APlaceIsAsFarOffAsTheNearestOfTheCourse) {
  const Crease line = stepped(0);
  const CourseOverS sut{k_columns_of_1_mm, line};
  // Square to a slope of 0.1; a turn on it is the same.
  DOUBLES_EQUAL(3 / std::hypot(1, 0.1), sut.off_mm({40, sut.z_mm(40) + 3}), 0.02);
  DOUBLES_EQUAL(sut.off_mm({40, 30}), sut.off_mm({340, 30}), 1e-9);
}

TEST(CourseGaps, AGapIsWhereNoCreaseShowsOrAnotherOneIsTaken) {
  Layers layers;
  layers.line = stepped(0);
  std::fill_n(layers.line.visible.begin() + 100, 10, std::uint8_t{0});  // a gap, with a crumb in it
  layers.line.visible[104] = 1;
  std::fill_n(layers.line.visible.begin() + 150, 4, std::uint8_t{0});  // too short
  std::fill_n(layers.line.visible.begin() + 295, 5, std::uint8_t{0});  // over the beginning
  std::fill_n(layers.line.visible.begin(), 5, std::uint8_t{0});
  layers.others.push_back({.first_col = 200, .cols = 20, .off_mm = 4});
  const std::vector<CourseGap> sut = gaps_of(k_columns_of_1_mm, layers, {.least_mm = 5});
  LONGS_EQUAL(3, sut.size());
  for (const CourseGap& gap : sut) {
    const int first = gap.first % k_columns_of_1_mm.cols;
    if (gap.changes) {
      // 8 mm to both sides: the course bends there.
      LONGS_EQUAL(192, first);
      LONGS_EQUAL(37, gap.cols);
    } else {
      CHECK(first == 100 || first == 295);
      LONGS_EQUAL(10, gap.cols);
    }
  }
}

TEST(CourseGaps, AnIslandDividesAGapUnlessItIsShorterThanAsked) {
  Layers layers;
  layers.line = stepped(0);
  std::fill_n(layers.line.visible.begin() + 100, 18, std::uint8_t{0});
  std::fill_n(layers.line.visible.begin() + 106, 6, std::uint8_t{1});
  LONGS_EQUAL(2, gaps_of(k_columns_of_1_mm, layers, {.least_mm = 5}).size());
  const std::vector<CourseGap> sut = gaps_of(k_columns_of_1_mm, layers, {.least_mm = 5, .island_mm = 8});
  LONGS_EQUAL(1, sut.size());
  LONGS_EQUAL(100, sut.front().first % k_columns_of_1_mm.cols);
  LONGS_EQUAL(18, sut.front().cols);
}

TEST(CourseGaps, ACreaseThatTurnsTooLittleCountsAsNone) {
  Layers layers;
  layers.line = stepped(0);
  std::fill_n(layers.line.turn_rad.begin() + 100, 40, 0.2F);
  std::fill_n(layers.line.turn_rad.begin() + 200, 40, 0.4F);
  CHECK(gaps_of(k_columns_of_1_mm, layers, {.least_mm = 5}).empty());
  const std::vector<CourseGap> sut =
      gaps_of(k_columns_of_1_mm, layers, {.least_mm = 5, .least_turn_rad = 0.3});
  LONGS_EQUAL(1, sut.size());
  LONGS_EQUAL(100, sut.front().first % k_columns_of_1_mm.cols);
  LONGS_EQUAL(40, sut.front().cols);
  CHECK(!sut.front().changes);
}

}  // namespace biteline::bite_line
