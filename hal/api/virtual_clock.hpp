// SPDX-License-Identifier: MIT
#pragma once
/// \file A clock that moves only when told: for tests and for sources that carry their own time.

#include <atomic>

#include "hal/api/clock.hpp"

namespace biteline::hal {

/// Thread: any thread reads, one thread moves it.
class VirtualClock final : public Clock {
 public:
  explicit VirtualClock(SensorClock::time_point start = SensorClock::time_point{})
      : now_ns_{start.time_since_epoch().count()} {}

  [[nodiscard]] SensorClock::time_point now() const noexcept override {
    return SensorClock::time_point{Nanoseconds{now_ns_.load(std::memory_order_acquire)}};
  }
  void advance(Nanoseconds step) noexcept { now_ns_.fetch_add(step.count(), std::memory_order_acq_rel); }
  void set(SensorClock::time_point instant) noexcept {
    now_ns_.store(instant.time_since_epoch().count(), std::memory_order_release);
  }

 private:
  std::atomic<std::int64_t> now_ns_;
};

}  // namespace biteline::hal
