// SPDX-License-Identifier: MIT
// Each cell has places and a pace of its own at the centre.
#include "host/fleet/intake.hpp"

#include <CppUTest/TestHarness.h>

#include <map>

namespace biteline::fleet {

TEST_GROUP(Intake) {
  Intake sut;
  Intake::Clock::time_point now{std::chrono::hours{1}};

  void put(const std::string& cell, std::int64_t seq) {
    FromCell one{.cell = cell, .shoe = {}};
    one.shoe.book = "b";
    one.shoe.seq = seq;
    sut.put(std::move(one), now);
  }
  /// How many of each cell.
  std::map<std::string, int> take(std::size_t most) {
    std::map<std::string, int> of;
    for (const FromCell& one : sut.take(most)) ++of[one.cell];
    return of;
  }
  /// What a flood of `rows` brings through, with the centre emptying between.
  int flood(int rows) {
    int through = 0;
    for (int i = 0; i < rows; ++i) {
      put("loud", i);
      through += static_cast<int>(sut.take(100).size());
    }
    return through;
  }
};

TEST(Intake, AFloodOfOneCellLeavesTheOthersTheirPlaces) {
  for (int i = 0; i < 20'000; ++i) put("loud", i);
  for (int i = 0; i < 100; ++i) put("quiet", i);
  const auto first = take(100);
  LONGS_EQUAL(50, first.at("quiet"));
  LONGS_EQUAL(50, first.at("loud"));
  LONGS_EQUAL(50, take(100).at("quiet"));
  LONGS_EQUAL(k_most_waiting_of_one - 100, take(1000).at("loud"));
  CHECK(sut.empty());
}

TEST(Intake, EachCellsRowsKeepTheirOrder) {
  for (int i = 1; i <= 30; ++i)
    for (const char* cell : {"c", "a", "b"}) put(cell, i);
  std::map<std::string, std::int64_t> last;
  while (!sut.empty()) {
    for (const FromCell& one : sut.take(7)) LONGS_EQUAL(++last[one.cell], one.shoe.seq);
  }
  for (const auto& [cell, seq] : last) LONGS_EQUAL(30, seq);
}

TEST(Intake, TheRowsOfAMinuteAreBoundedAndItsCellIsTold) {
  STRCMP_EQUAL("", sut.held_words("loud", now).c_str());
  LONGS_EQUAL(static_cast<int>(k_rows_at_once), flood(20'000));
  STRCMP_CONTAINS("later", sut.held_words("loud", now).c_str());
  STRCMP_EQUAL("", sut.held_words("quiet", now).c_str());
  now += std::chrono::minutes{1};
  STRCMP_EQUAL("", sut.held_words("loud", now).c_str());
  LONGS_EQUAL(static_cast<int>(k_rows_a_minute), flood(20'000));
  // An hour of silence gives no more than what may come at once.
  now += std::chrono::hours{1};
  LONGS_EQUAL(static_cast<int>(k_rows_at_once), flood(20'000));
}

TEST(Intake, AFactorysShoesAreNeverHeld) {
  // A shoe each 10 s from 100 cells for an hour, and one cell that was away for a day.
  for (int i = 0; i < 2000; ++i) {
    put("away", i);
    static_cast<void>(sut.take(100));
  }
  for (int second = 0; second < 3600; second += 10) {
    now += std::chrono::seconds{10};
    for (int cell = 0; cell < 100; ++cell) put("cell-" + std::to_string(cell), second);
    std::size_t came = 0;
    while (!sut.empty()) came += sut.take(100).size();
    LONGS_EQUAL(100, came);
  }
  STRCMP_EQUAL("", sut.held_words("away", now).c_str());
}

TEST(Intake, WhatWaitsIsForgottenButNotWhoWasTooQuick) {
  flood(20'000);
  put("quiet", 1);
  sut.clear();
  CHECK(sut.empty());
  STRCMP_CONTAINS("later", sut.held_words("loud", now).c_str());
}

}  // namespace biteline::fleet
