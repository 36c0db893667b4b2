// SPDX-License-Identifier: MIT
#pragma once
/// \file What every PwmOut must do.

#include <CppUTest/TestHarness.h>

#include "hal/api/pwm_out.hpp"

namespace biteline::conformance {

using namespace std::chrono_literals;

inline void check_pwm_out(hal::PwmOut& sut) {
  CHECK_FALSE(sut.running());
  CHECK(sut.start().error().code == Errc::WrongState);
  CHECK(sut.configure({.period = 10ms, .pulse = 11ms}).error().code == Errc::BadValue);
  CHECK(sut.configure({.period = 0ns, .pulse = 0ns}).error().code == Errc::BadValue);

  const hal::PwmSettings wanted{.period = 10ms, .pulse = 500us};
  const Result<hal::PwmSettings> got = sut.configure(wanted);
  CHECK(got.has_value());
  // 1 %: beyond it configure() has to refuse.
  CHECK(std::chrono::abs(got->period - wanted.period) <= wanted.period / 100);
  CHECK(std::chrono::abs(got->pulse - wanted.pulse) <= wanted.pulse / 100);
  CHECK_FALSE(sut.running());

  CHECK(sut.start().has_value());
  CHECK(sut.running());
  CHECK(sut.start().has_value());
  CHECK(sut.configure({.period = 5ms, .pulse = 1ms}).has_value());  // shorter and longer, while it runs
  CHECK(sut.configure({.period = 20ms, .pulse = 8ms}).has_value());
  CHECK(sut.running());
  CHECK(sut.stop().has_value());
  CHECK_FALSE(sut.running());
  CHECK(sut.stop().has_value());
  CHECK(sut.start().has_value());
  CHECK(sut.stop().has_value());
}

}  // namespace biteline::conformance
