// SPDX-License-Identifier: MIT
#include "hal/sim/robot/power.hpp"

#include <CppUTest/TestHarness.h>

namespace biteline::sim {
namespace {

SensorClock::time_point at_ms(int time_ms) {
  return SensorClock::time_point{Nanoseconds{1'000'000LL * (5000 + time_ms)}};
}

}  // namespace

TEST_GROUP(Power) {
  Power sut;
  void is(RobotMode mode, int time_ms) const {
    LONGS_EQUAL(static_cast<int>(mode), static_cast<int>(sut.mode(at_ms(time_ms))));
  }
};

TEST(Power, BootsThenReleasesItsBrakesInTime) {
  is(RobotMode::Running, 0);
  sut.switch_off();
  is(RobotMode::PowerOff, 0);
  sut.switch_on(at_ms(0));
  is(RobotMode::Booting, 149);
  is(RobotMode::Idle, 150);
  is(RobotMode::Idle, 100'000);
  sut.release_brakes(at_ms(1000));
  is(RobotMode::Idle, 1149);
  is(RobotMode::Running, 1150);
}

TEST(Power, BrakesReleasedFromOffBootFirst) {
  sut.switch_off();
  sut.release_brakes(at_ms(0));
  is(RobotMode::Booting, 149);
  is(RobotMode::Idle, 299);
  is(RobotMode::Running, 300);
}

TEST(Power, WhatIsOnStaysAsItIsWhenSwitchedOn) {
  sut.switch_on(at_ms(0));
  sut.release_brakes(at_ms(0));
  is(RobotMode::Running, 0);
}

TEST(Power, APersonsHandTakesNoTime) {
  sut.set(false);
  is(RobotMode::PowerOff, 0);
  sut.set(true);
  is(RobotMode::Running, 0);
}

}  // namespace biteline::sim
