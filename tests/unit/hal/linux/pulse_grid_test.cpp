// SPDX-License-Identifier: MIT
#include "hal/linux/pwm/pulse_grid.hpp"

#include <CppUTest/TestHarness.h>

namespace biteline::hal {
namespace {

using namespace std::chrono_literals;

TEST_GROUP(PulseGrid) {
  SensorClock::time_point start{1s};
  PulseGrid sut{start, 10ms};
};

TEST(PulseGrid, LateWakeUpDoesNotShiftTheGrid) {
  CHECK(sut.on_wake(start + 3ms));
  CHECK(sut.next() == start + 10ms);
  CHECK(sut.health().late_max == 3ms);
}

TEST(PulseGrid, SlotsSleptThroughAreSkippedAndCounted) {
  CHECK_FALSE(sut.on_wake(start + 32ms));
  CHECK(sut.next() == start + 30ms);
  CHECK_EQUAL(3, sut.health().slots_skipped);
  CHECK(sut.on_wake(start + 32ms));
  CHECK_EQUAL(1, sut.health().pulses);
}

TEST(PulseGrid, PulseNearerToItsNeighbourIsNotGiven) {
  CHECK(sut.on_wake(start + 4999us));
  CHECK_FALSE(sut.on_wake(start + 10ms + 5ms));
  CHECK(sut.next() == start + 20ms);
}

}  // namespace
}  // namespace biteline::hal
