// SPDX-License-Identifier: MIT
#include "host/robot/link/state_age.hpp"

#include <CppUTest/TestHarness.h>

#include <algorithm>

namespace biteline::robot {

TEST_GROUP(StateAge) {
  StateAge sut;
  /// By the clocks of the two machines.
  double take(double sampled_s, double received_s) {
    RobotState state;
    state.sampled = RobotClock::time_point{Nanoseconds{static_cast<std::int64_t>(sampled_s * 1e9)}};
    state.received = HostClock::time_point{Nanoseconds{static_cast<std::int64_t>(received_s * 1e9)}};
    return sut.take(state);
  }
};

TEST(StateAge, ADelayThatIsAlwaysThereIsNoAge) {
  for (int i = 0; i < 1000; ++i) DOUBLES_EQUAL(0, take(50 + 0.002 * i, 7000.3 + 0.002 * i), 1e-5);
}

TEST(StateAge, ClocksThatDriftApartForADayAreNoAge) {
  for (const double drift : {1e-4, -1e-4}) {
    sut = {};
    double oldest_s = 0;
    for (int i = 0; i < 86'400; ++i) oldest_s = std::max(oldest_s, take(1e5 + i * (1.0 - drift), 10.0 + i));
    CHECK(oldest_s < 1e-3);
  }
}

TEST(StateAge, LagThatGrowsIsAnAge) {
  static_cast<void>(take(0, 100));
  double age_s = 0, time_s = 0;
  for (; age_s <= 0.1 && time_s < 10; time_s += 0.002) age_s = take(time_s, 100 + time_s + 0.12 * time_s);
  DOUBLES_EQUAL(0.1 / 0.12, time_s, 0.01);
}

TEST(StateAge, StatesHeldUpAreOldUntilTheyComeAsBefore) {
  for (int i = 0; i < 100; ++i) static_cast<void>(take(0.01 * i, 5 + 0.01 * i));
  for (int i = 100; i < 200; ++i) DOUBLES_EQUAL(0.3, take(0.01 * i, 5.3 + 0.01 * i), 0.001);
  DOUBLES_EQUAL(0, take(2, 7), 0.001);
}

TEST(StateAge, FirstStatesThatWereHeldUpMakeNobodyYounger) {
  static_cast<void>(take(0, 10.5));
  DOUBLES_EQUAL(0, take(1, 11), 1e-9);
  DOUBLES_EQUAL(0.2, take(2, 12.2), 0.001);
}

/// One stamp from the future makes what follows old, never young.
TEST(StateAge, StampFromTheFutureMakesTheOthersOld) {
  static_cast<void>(take(1, 10));
  DOUBLES_EQUAL(0, take(31, 10.01), 1e-9);
  CHECK(take(1.02, 10.02) > 29);
}

}  // namespace biteline::robot
