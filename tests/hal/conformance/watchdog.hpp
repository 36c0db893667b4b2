// SPDX-License-Identifier: MIT
#pragma once
/// \file What every Watchdog that can be stopped must do.

#include <CppUTest/TestHarness.h>

#include "hal/api/watchdog.hpp"

namespace biteline::conformance {

using namespace std::chrono_literals;

inline void check_watchdog(hal::Watchdog& sut) {
  CHECK(sut.feed().error().code == Errc::WrongState);
  CHECK(sut.disarm().has_value());
  CHECK(sut.arm(0ns).error().code == Errc::BadValue);
  const Result<Nanoseconds> timeout = sut.arm(9500ms);
  CHECK(timeout.has_value());
  CHECK(*timeout >= 9500ms);
  for (int i = 0; i < 10; ++i) CHECK(sut.feed().has_value());
  CHECK(sut.arm(20s).has_value());
  CHECK(sut.disarm().has_value());
  CHECK(sut.feed().error().code == Errc::WrongState);
}

}  // namespace biteline::conformance
