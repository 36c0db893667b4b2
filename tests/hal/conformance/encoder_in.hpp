// SPDX-License-Identifier: MIT
#pragma once
/// \file What every EncoderIn must do.

#include <CppUTest/TestHarness.h>

#include <functional>
#include <thread>

#include "hal/api/encoder_in.hpp"

namespace biteline::conformance {

/// `move_to`: the axis goes to that place, in ticks, or stands there, and what tells it is under way.
inline void check_encoder_in(hal::EncoderIn& sut, const std::function<void(std::uint32_t)>& move_to) {
  CHECK(sut.read().error().code == Errc::Timeout);
  struct Step {
    std::uint32_t place_ticks;
    std::int64_t way_ticks;
  };
  constexpr Step k_steps[] = {{1000, 0}, {1010, 10}, {990, -10}, {5, -995}, {0xFFFFFFF0U, -1016}, {1000, 0}};
  SensorClock::time_point last{};
  for (const Step& step : k_steps) {
    const auto there = [&](const Result<hal::EncoderReading>& reading) {
      return reading && reading->position_ticks == step.way_ticks && reading->stamp > last;
    };
    move_to(step.place_ticks);
    Result<hal::EncoderReading> reading = sut.read();
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds{5};
    while (!there(reading) && std::chrono::steady_clock::now() < deadline) {
      std::this_thread::sleep_for(std::chrono::milliseconds{1});
      move_to(step.place_ticks);  // an encoder that stands still goes on telling where
      reading = sut.read();
    }
    CHECK(reading.has_value());
    CHECK_EQUAL(step.way_ticks, reading->position_ticks);
    CHECK(reading->stamp > last);
    CHECK_EQUAL(0, reading->errors);
    last = reading->stamp;
  }
}

}  // namespace biteline::conformance
