// SPDX-License-Identifier: MIT
// A mock PTP clock and the software watchdog of the kernel.
#include <CppUTest/TestHarness.h>

#include <cstdlib>
#include <fstream>
#include <string>

#include "hal/linux/ptp/phc.hpp"
#include "hal/linux/watchdog/kernel_watchdog.hpp"
#include "tests/hal/conformance/watchdog.hpp"
#include "tests/hal/kernel/skip.hpp"

namespace biteline::hal {
namespace {

using namespace std::chrono_literals;

constexpr const char* k_ptp = "/dev/ptp0";
constexpr const char* k_watchdog = "/dev/watchdog0";

TEST_GROUP(ClocksKernel){};

TEST(ClocksKernel, OffsetOfThePtpClockIsSteadyWithinItsUncertainty) {
  if (std::getenv("BITELINE_WITHOUT_PTP") != nullptr)
    return test::note_skipped("this kernel has no mock PTP clock");
  BITELINE_DEVICE_OR_SKIP(k_ptp);
  const Phc sut = Phc::open(k_ptp).value();
  const ReferenceClock::Reading first = sut.measure().value();
  CHECK(first.uncertainty > 0ns);
  for (int i = 0; i < 20; ++i) {
    const ReferenceClock::Reading next = sut.measure().value();
    CHECK(next.at > first.at);
    // The mock runs on CLOCK_MONOTONIC_RAW, which the discipline of CLOCK_MONOTONIC leaves by less than 500
    // ppm.
    const Nanoseconds drift = (next.at - first.at) / 2000;
    CHECK(std::chrono::abs(next.offset - first.offset) <= first.uncertainty + next.uncertainty + drift);
  }
}

TEST(ClocksKernel, WatchdogConforms) {
  BITELINE_DEVICE_OR_SKIP(k_watchdog);
  conformance::check_watchdog(*KernelWatchdog::open(k_watchdog).value());
}

TEST(ClocksKernel, DroppedWatchdogStaysArmed) {
  BITELINE_DEVICE_OR_SKIP(k_watchdog);
  const auto state = [] {
    std::string text;
    std::ifstream{"/sys/class/watchdog/watchdog0/state"} >> text;
    return text;
  };
  auto sut = KernelWatchdog::open(k_watchdog).value();
  CHECK(state() == "inactive");
  CHECK(sut->arm(60s).has_value());
  sut.reset();
  CHECK(state() == "active");
  sut = KernelWatchdog::open(k_watchdog).value();
  CHECK(sut->arm(60s).has_value());
  CHECK(sut->disarm().has_value());
  CHECK(state() == "inactive");
}

}  // namespace
}  // namespace biteline::hal
