// SPDX-License-Identifier: MIT
#include "firmware/runtime/laser_guard.hpp"

#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <functional>

#include "firmware/runtime/thread_table.hpp"

namespace biteline::runtime {
namespace {

using std::chrono::milliseconds;

}  // namespace

TEST_GROUP(LaserGuard) {
  LaserGuard::Config config;
  LaserGuard sut{config};
  LaserInputs inputs;

  void setup() override {
    inputs.now = SensorClock::time_point{Nanoseconds{1'000'000'000'000}};
    inputs.scan_on = true;
    inputs.interlock_closed = true;
    inputs.key_on = true;
    fresh();
  }
  void fresh() {
    inputs.last_frame = inputs.watchdog_fed = inputs.stream_alive = inputs.now;
  }
  /// One period of the safety thread, everything well.
  bool step() {
    inputs.now += threads::k_safety.period;
    fresh();
    return sut.look(inputs);
  }
  void is(LaserGuard::State state, LaserOff reason) {
    LONGS_EQUAL(static_cast<int>(state), static_cast<int>(sut.state()));
    STRCMP_EQUAL(text(reason), text(sut.reason()));
  }
};

TEST(LaserGuard, IsOffByDefault) {
  is(LaserGuard::State::Off, LaserOff::NotAsked);
}

TEST(LaserGuard, IsOnWhileAllIsWellAndAScanIsOn) {
  CHECK(sut.look(inputs));
  for (int i = 0; i < 100; ++i) CHECK(step());
  inputs.scan_on = false;
  CHECK(!step());
  is(LaserGuard::State::Off, LaserOff::NotAsked);
  inputs.scan_on = true;
  CHECK(step());
}

TEST(LaserGuard, NeverComesOnWhileAnythingForbidsIt) {
  inputs.interlock_closed = false;
  CHECK(!sut.look(inputs));
  is(LaserGuard::State::Off, LaserOff::InterlockOpen);
  inputs.interlock_closed = true;
  inputs.key_on = false;
  CHECK(!sut.look(inputs));
  is(LaserGuard::State::Off, LaserOff::KeyOff);
  // Neither was a fault: nothing had been on.
  inputs.key_on = true;
  CHECK(sut.look(inputs));
}

TEST(LaserGuard, WaitsForFramesToFlowAndForTheWatchdog) {
  inputs.last_frame = SensorClock::time_point::min();
  CHECK(!sut.look(inputs));
  is(LaserGuard::State::Off, LaserOff::FramesStopped);
  inputs.last_frame = inputs.now;
  inputs.watchdog_fed = SensorClock::time_point::min();
  CHECK(!sut.look(inputs));
  is(LaserGuard::State::Off, LaserOff::WatchdogStarved);
  inputs.watchdog_fed = inputs.now;
  inputs.stream_alive = SensorClock::time_point::min();
  CHECK(!sut.look(inputs));
  is(LaserGuard::State::Off, LaserOff::StreamStarved);
  inputs.stream_alive = inputs.now;
  CHECK(sut.look(inputs));
}

/// Every fault: dark at the next look (or within its patience), latched though the fault goes away, and free
/// again only after the scan was switched off.
TEST(LaserGuard, EveryFaultLatchesUntilTheScanIsAskedForAnew) {
  struct Row {
    LaserOff reason;
    std::function<void(LaserInputs&)> fault;
    Nanoseconds patience;
  };
  const Row rows[] = {
      {LaserOff::InterlockOpen, [](LaserInputs& in) { in.interlock_closed = false; }, Nanoseconds{0}},
      {LaserOff::KeyOff, [](LaserInputs& in) { in.key_on = false; }, Nanoseconds{0}},
      {LaserOff::TooHot, [](LaserInputs& in) { in.too_hot = true; }, Nanoseconds{0}},
      {LaserOff::DriverFailed, [](LaserInputs& in) { in.driver_failed = true; }, Nanoseconds{0}},
      {LaserOff::SafetyHung, [](LaserInputs& in) { in.looks_missed = in.driver_failed = true; },
       Nanoseconds{0}},
      {LaserOff::FramesStopped, [](LaserInputs& in) { in.last_frame = SensorClock::time_point{}; },
       config.frames_within},
      {LaserOff::WatchdogStarved, [](LaserInputs& in) { in.watchdog_fed = SensorClock::time_point{}; },
       config.watchdog_within},
      {LaserOff::StreamStarved, [](LaserInputs& in) { in.stream_alive = SensorClock::time_point{}; },
       config.stream_within},
  };
  for (const Row& row : rows) {
    sut = LaserGuard{config};
    setup();
    CHECK(sut.look(inputs));
    CHECK(step());
    if (row.patience > Nanoseconds{0}) {
      // Silence, not a stamp that jumps back: time goes on without the sign of life.
      LaserInputs silent = inputs;
      Nanoseconds dark_after{0};
      bool on = true;
      while (on) {
        silent.now += threads::k_safety.period;
        dark_after += threads::k_safety.period;
        silent.last_frame = row.reason == LaserOff::FramesStopped ? inputs.last_frame : silent.now;
        silent.watchdog_fed = row.reason == LaserOff::WatchdogStarved ? inputs.watchdog_fed : silent.now;
        silent.stream_alive = row.reason == LaserOff::StreamStarved ? inputs.stream_alive : silent.now;
        on = sut.look(silent);
      }
      CHECK(dark_after <= milliseconds{100});
      CHECK(dark_after > row.patience);
      inputs.now = silent.now;
    } else {
      row.fault(inputs);
      CHECK(!sut.look(inputs));
    }
    is(LaserGuard::State::Latched, row.reason);
    // The fault goes away; the light does not come back by itself.
    inputs.interlock_closed = inputs.key_on = true;
    inputs.driver_failed = inputs.looks_missed = inputs.too_hot = false;
    for (int i = 0; i < 50; ++i) CHECK(!step());
    is(LaserGuard::State::Latched, row.reason);
    inputs.scan_on = false;
    CHECK(!step());
    is(LaserGuard::State::Off, row.reason);
    inputs.scan_on = true;
    CHECK(step());
  }
}

TEST(LaserGuard, FailedDriverLatchesEvenBeforeTheFirstLight) {
  inputs.driver_failed = true;
  CHECK(!sut.look(inputs));
  is(LaserGuard::State::Latched, LaserOff::DriverFailed);
}

TEST(LaserGuard, StopIsForGood) {
  CHECK(sut.look(inputs));
  sut.stop();
  CHECK(!step());
  inputs.scan_on = false;
  CHECK(!step());
  inputs.scan_on = true;
  CHECK(!step());
  is(LaserGuard::State::Stopped, LaserOff::Stopped);
}

TEST(LaserGuard, WorstDarknessDelayStaysBelowTheLimit) {
  // Patience, plus a look that has just passed, plus one missed look.
  const Nanoseconds worst = std::max({config.frames_within, config.watchdog_within, config.stream_within}) +
                            2 * threads::k_safety.period;
  CHECK(worst < milliseconds{100});
}

}  // namespace biteline::runtime
