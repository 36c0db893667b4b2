// SPDX-License-Identifier: MIT
#pragma once
/// \file Clock tags.  Time points of different clocks neither compare nor subtract: mixing them does not
/// compile.

#include <chrono>
#include <cstdint>

namespace biteline {

using Nanoseconds = std::chrono::duration<std::int64_t, std::nano>;

/// The sensor's one clock: every stamp in a profile is on it (CLOCK_MONOTONIC on a unit, the camera clock in
/// a recorded session).
struct SensorClock {
  using duration = Nanoseconds;
  using rep = duration::rep;
  using period = duration::period;
  using time_point = std::chrono::time_point<SensorClock>;
  static constexpr bool is_steady = true;
};

/// The robot controller's clock, as stamped by the pose source.
struct RobotClock {
  using duration = Nanoseconds;
  using rep = duration::rep;
  using period = duration::period;
  using time_point = std::chrono::time_point<RobotClock>;
  static constexpr bool is_steady = true;
};

/// The host's monotonic clock.
struct HostClock {
  using duration = Nanoseconds;
  using rep = duration::rep;
  using period = duration::period;
  using time_point = std::chrono::time_point<HostClock>;
  static constexpr bool is_steady = true;
};

/// `pose_clock_offset_ns` of a sensor's settings: robot clock minus sensor clock.
[[nodiscard]] constexpr SensorClock::time_point to_sensor_clock(RobotClock::time_point stamp,
                                                                Nanoseconds pose_clock_offset) {
  return SensorClock::time_point{stamp.time_since_epoch() - pose_clock_offset};
}

}  // namespace biteline
