// SPDX-License-Identifier: MIT
#pragma once
/// \file The sensor's one clock, as an object, so that tests can own the time.

#include <chrono>

#include "common/time/clocks.hpp"

namespace biteline::hal {

/// Thread: any.  RT: now() is one vDSO read in the backend for real use; no call fails.
class Clock {
 public:
  Clock() = default;
  Clock(const Clock&) = delete;
  Clock& operator=(const Clock&) = delete;
  virtual ~Clock() = default;

  [[nodiscard]] virtual SensorClock::time_point now() const noexcept = 0;
};

/// CLOCK_MONOTONIC (what std::chrono::steady_clock reads on Linux, and what V4L2, libgpiod and SocketCAN
/// stamp with).
class MonotonicClock final : public Clock {
 public:
  [[nodiscard]] SensorClock::time_point now() const noexcept override {
    return SensorClock::time_point{
        std::chrono::duration_cast<Nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())};
  }
};

}  // namespace biteline::hal
