// SPDX-License-Identifier: MIT
#include "host/apps/biteline-host/told_once.hpp"

#include <CppUTest/TestHarness.h>

#include <chrono>
#include <vector>

namespace biteline::service {

TEST_GROUP(ToldOnce) {
  ToldOnce sut;
  HostClock::time_point now{std::chrono::hours{1}};

  ToldOnce::Heard hear(const std::string& words) {
    return sut.hear(words, now);
  }
  void pass(int seconds) {
    now += std::chrono::seconds{seconds};
  }
};

TEST(ToldOnce, WhatIsWrongEachSecondIsToldAfterTwoFourEightSecondsAndAtLastEachMinute) {
  std::vector<int> told;
  for (int second = 0; second < 300; ++second) {
    if (hear("no sensor answers").tells) told.push_back(second);
    pass(1);
  }
  const std::vector<int> expected{0, 2, 6, 14, 30, 62, 122, 182, 242};
  CHECK(expected == told);
}

TEST(ToldOnce, WhoeverTriesAgainWaitsAsLongAndIsToldEachTime) {
  // Each try takes 16 s, as a scan does.
  for (const int wait_s : {2, 4, 8, 16, 32, 60, 60}) {
    const ToldOnce::Heard heard = hear("0 of 815 profiles can be used: no pose (815)");
    CHECK(heard.tells);
    LONGS_EQUAL(wait_s, heard.wait / std::chrono::seconds{1});
    pass(wait_s + 16);
  }
}

TEST(ToldOnce, FiguresMakeNoOtherWordsAndOtherWordsAreToldAtOnce) {
  CHECK(hear("0 of 815 profiles can be used: no pose (815), 1.5 s").tells);
  CHECK_FALSE(hear("12 of 9 profiles can be used: no pose (3), 120.25 s").tells);
  CHECK(hear("12 of 9 profiles can be used: no stripe (3), 120.25 s").tells);
  // A point that ends a sentence is none of a figure.
  CHECK(hear("frame 7. no pose").tells);
  CHECK(hear("frame 7 no pose").tells);
}

TEST(ToldOnce, WordsThatTakeTurnsAreNotToldEachTime) {
  int told = 0;
  for (int look = 0; look < 60; ++look) {
    told += hear(look % 2 == 0 ? "it still moves" : "no answer in time").tells ? 1 : 0;
    pass(2);
  }
  // Two minutes: six times each at most.
  CHECK(told <= 12);
  CHECK(told >= 8);
}

TEST(ToldOnce, WhatWasNotToldIsCounted) {
  CHECK(hear("away").tells);
  CHECK_FALSE(hear("away").tells);
  pass(1);
  CHECK_FALSE(hear("away").tells);
  pass(1);
  const ToldOnce::Heard again = hear("away");
  CHECK(again.tells);
  LONGS_EQUAL(2, again.untold);
  STRCMP_EQUAL("away (2 times more since it was told)", with_count("away", again).c_str());
  pass(4);
  STRCMP_EQUAL("away", with_count("away", hear("away")).c_str());
}

TEST(ToldOnce, WhatWentWellOrWasNotHeardForLongBeginsAnew) {
  for (int i = 0; i < 5; ++i) {
    static_cast<void>(hear("away"));
    pass(60);
  }
  LONGS_EQUAL(60, hear("away").wait / std::chrono::seconds{1});
  sut.mended();
  LONGS_EQUAL(2, hear("away").wait / std::chrono::seconds{1});
  pass(60);
  LONGS_EQUAL(4, hear("away").wait / std::chrono::seconds{1});
  pass(601);
  LONGS_EQUAL(2, hear("away").wait / std::chrono::seconds{1});
}

}  // namespace biteline::service
