// SPDX-License-Identifier: MIT
#pragma once
/// \file A camera clock that nobody disciplines, mapped to the sensor's clock by when its frames arrive.

#include <cstdint>
#include <optional>

#include "common/time/clocks.hpp"

namespace biteline::hal {

/// Frames arrive late by a least time plus whatever the network adds, so the smallest (arrival - stamp) seen
/// is the best one.  It is forgotten slowly, so that a camera clock that drifts is followed.  What stays
/// unknown is the least delay itself (read-out and transfer): a stamp made so is early or late by that much
/// until it is calibrated away. Pure; thread: one owner.
class ArrivalClock {
 public:
  /// Two quartz clocks differ by less than this; the smallest difference is let go at this rate.
  static constexpr double k_drift_ratio = 100e-6;

  /// The instant on the sensor's clock of `camera_stamp`, after learning from this frame's arrival.
  [[nodiscard]] SensorClock::time_point map(Nanoseconds camera_stamp, SensorClock::time_point arrival) {
    const Nanoseconds difference = arrival.time_since_epoch() - camera_stamp;
    if (smallest_) {
      const auto waited = static_cast<double>((camera_stamp - last_stamp_).count());
      *smallest_ += Nanoseconds{static_cast<std::int64_t>(k_drift_ratio * waited)};
    }
    if (!smallest_ || difference < *smallest_) smallest_ = difference;
    last_stamp_ = camera_stamp;
    return SensorClock::time_point{camera_stamp + *smallest_};
  }

  void reset() { smallest_.reset(); }

 private:
  std::optional<Nanoseconds> smallest_;
  Nanoseconds last_stamp_{0};
};

}  // namespace biteline::hal
