// SPDX-License-Identifier: MIT
#include "host/bite_line/mend/led_course.hpp"

#include <CppUTest/TestHarness.h>

#include <algorithm>

namespace biteline::mend {

TEST_GROUP(LedCourse) {
  static constexpr int rows = 20, cols = 40;
  bite_line::PathConfig config{.max_step_rows = 4, .step_cost = 0.03};
  std::vector<float> cost = std::vector<float>(std::size_t{rows} * cols, 1.0F);

  void groove(int row, int from, int to) {
    for (int col = from; col < to; ++col)
      cost[static_cast<std::size_t>(col) * rows + static_cast<std::size_t>(row)] = 0;
  }
};

TEST(LedCourse, FollowsTheCheapestWayBetweenItsEnds) {
  groove(5, 0, cols);
  const auto sut = led_course(cost, rows, 5, 5, {}, config);
  CHECK(sut.has_value());
  CHECK(std::ranges::all_of(*sut, [](int row) { return row == 5; }));
}

TEST(LedCourse, IsLedFromOneGrooveToAnotherAndSnapsToIt) {
  groove(5, 0, 12);
  groove(12, 12, 28);
  groove(5, 28, cols);
  const Lead lead{.col = 20, .row = 14, .reach_rows = 3};
  const auto sut = led_course(cost, rows, 5, 5, {&lead, 1}, config);
  CHECK(sut.has_value());
  LONGS_EQUAL(5, sut->front());
  LONGS_EQUAL(5, sut->back());
  // Two rows off the groove: within reach the groove decides.
  for (int col = 16; col < 24; ++col) LONGS_EQUAL(12, sut->at(static_cast<std::size_t>(col)));
}

TEST(LedCourse, WhatIsTooSteepHasNoCourse) {
  const Lead lead{.col = 2, .row = 19, .reach_rows = 1};
  CHECK_FALSE(led_course(cost, rows, 0, 0, {&lead, 1}, config).has_value());
  const Lead beyond{.col = cols, .row = 3, .reach_rows = 1};
  CHECK_FALSE(led_course(cost, rows, 0, 0, {&beyond, 1}, config).has_value());
  CHECK_FALSE(led_course(cost, rows, 0, rows, {}, config).has_value());
}

}  // namespace biteline::mend
