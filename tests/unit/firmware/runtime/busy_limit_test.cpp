// SPDX-License-Identifier: MIT
#include "firmware/runtime/busy_limit.hpp"

#include <CppUTest/TestHarness.h>

#include <chrono>

namespace biteline::runtime {

using std::chrono::milliseconds;

TEST_GROUP(BusyLimit) {
  BusyLimit sut;
  SensorClock::time_point now{milliseconds{5000}};

  /// One frame: `waited` for it, then `worked` on it.  Returns the rest asked for, after which the next
  /// begins.
  Nanoseconds frame(Nanoseconds waited, Nanoseconds worked) {
    now += waited;
    const Nanoseconds rest = sut.rest_due(now, waited);
    now += rest + worked;
    return rest;
  }
};

TEST(BusyLimit, ThreadThatWaitsForAQuarterOfItsTimeIsLeftAlone) {
  for (int i = 0; i < 1000; ++i) CHECK(frame(milliseconds{3}, milliseconds{7}) == Nanoseconds{0});
}

TEST(BusyLimit, ThreadWhoseFramesAreAllThereAlreadySleepsATenthOfItsTime) {
  const SensorClock::time_point begin = now;
  Nanoseconds slept{0};
  for (int i = 0; i < 1000; ++i) slept += frame(Nanoseconds{0}, milliseconds{12});
  const double share =
      static_cast<double>(slept.count()) / static_cast<double>(Nanoseconds{now - begin}.count());
  DOUBLES_EQUAL(0.1, share, 0.02);  // a rest begins anew with a whole frame
}

TEST(BusyLimit, WhatTheThreadWaitedIsTakenOffItsRest) {
  Nanoseconds slept{0};
  for (int i = 0; i < 1000; ++i) slept += frame(milliseconds{1}, milliseconds{19});
  CHECK(slept > milliseconds{700});  // 5 of 10 % of 20 s
  CHECK(slept < milliseconds{1300});
}

TEST(BusyLimit, ProcessThatStoodStillForSecondsRestsNoLongerThanTheLaserGuardsPatience) {
  CHECK(frame(Nanoseconds{0}, milliseconds{30000}) == Nanoseconds{0});
  CHECK(frame(Nanoseconds{0}, milliseconds{12}) == milliseconds{20});
}

}  // namespace biteline::runtime
