// SPDX-License-Identifier: MIT
// What a cell sends: in order, not before the centre has spoken, and again until it is committed.
#include "host/fleet/uplink.hpp"

#include <CppUTest/TestHarness.h>

namespace biteline::fleet {

TEST_GROUP(Uplink) {
  Uplink sut;
  Uplink::Clock::time_point now{std::chrono::hours{1}};

  void setup() override {
    sut.use_book("b");
  }
  void hear(std::int64_t seq, const char* book = "b") {
    sut.hear({.book = book, .seq = seq}, now);
  }
  /// -1: nothing is to be sent.
  std::int64_t next() {
    return sut.next(now).value_or(-1);
  }
  void send(std::int64_t from, std::int64_t to) {
    for (std::int64_t seq = from; seq <= to; ++seq) sut.sent(seq, now);
  }
};

TEST(Uplink, NothingIsSentBeforeTheCentreHasSpoken) {
  LONGS_EQUAL(-1, next());
  hear(3, "another book");
  LONGS_EQUAL(-1, next());
  hear(3);
  LONGS_EQUAL(3, next());
}

TEST(Uplink, NoMoreThanTheWindowIsOnTheWay) {
  hear(0);
  send(1, k_most_on_the_way);
  LONGS_EQUAL(-1, next());
  hear(40);
  LONGS_EQUAL(k_most_on_the_way, next());
  LONGS_EQUAL(40, sut.room());
  hear(k_most_on_the_way);
  LONGS_EQUAL(k_most_on_the_way, sut.room());
}

TEST(Uplink, WhatIsNotCommittedIsSentAgainFromThere) {
  hear(5);
  send(6, 9);
  LONGS_EQUAL(9, next());
  now += k_patience;
  LONGS_EQUAL(9, next());
  now += std::chrono::milliseconds{1};
  LONGS_EQUAL(5, next());
  send(6, 9);
  hear(7);
  now += k_patience + std::chrono::milliseconds{1};
  LONGS_EQUAL(7, next());
}

TEST(Uplink, NewLineWaitsForTheCentreAgain) {
  hear(5);
  send(6, 8);
  sut.begin_line();
  LONGS_EQUAL(-1, next());
  hear(6);
  LONGS_EQUAL(6, next());
}

TEST(Uplink, DatabaseThatWasPutBackGetsAllSinceThen) {
  hear(50);
  send(51, 60);
  hear(20);
  LONGS_EQUAL(20, next());
}

TEST(Uplink, ARowThatIsNeverTakenGoesAsAStubAndTheNextOnesFollow) {
  hear(5);
  send(6, 20);
  for (int round = 0; round < k_most_in_vain; ++round) {
    CHECK_TEXT(!sut.bare(), "too soon");
    hear(5);  // the centre lives, and takes nothing
    now += k_patience + std::chrono::milliseconds{1};
    LONGS_EQUAL(5, next());
    if (!sut.bare()) send(6, 20);
  }
  CHECK(sut.bare());
  LONGS_EQUAL(1, sut.room());
  send(6, 6);
  LONGS_EQUAL(-1, next());
  hear(6);
  CHECK(!sut.bare());
  LONGS_EQUAL(6, next());
  LONGS_EQUAL(k_most_on_the_way, sut.room());
}

TEST(Uplink, ACentreThatIsAwayOrTakesRowsLaterRefusesNone) {
  hear(5);
  send(6, 20);
  for (int round = 0; round < 5 * k_most_in_vain; ++round) {
    if (round % 2 == 0) sut.hear({.book = "b", .seq = 5, .held = "later"}, now);
    now += k_patience + std::chrono::milliseconds{1};
    LONGS_EQUAL(5, next());
    send(6, 20);
  }
  CHECK(!sut.bare());
}

TEST(Uplink, AnotherMemoryBeginsAnew) {
  hear(50);
  sut.use_book("c");
  LONGS_EQUAL(-1, next());
  hear(50);
  LONGS_EQUAL(-1, next());
  hear(0, "c");
  LONGS_EQUAL(0, next());
}

}  // namespace biteline::fleet
