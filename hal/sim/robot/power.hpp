// SPDX-License-Identifier: MIT
#pragma once
/// \file The simulated arm's power and brakes.

#include <cstdint>
#include <mutex>

#include "common/time/clocks.hpp"

namespace biteline::sim {

/// Universal Robots' numbers: RTDE guide, robot_mode.
enum class RobotMode : std::uint8_t { Booting = 2, PowerOff = 3, Idle = 5, Running = 7 };

/// Running at first.  To boot and to release the brakes take 0.15 s each; a real arm takes some seconds.
/// Thread: any.
class Power {
 public:
  /// Off, or running at once: what was done out of sight.
  void set(bool on);
  void switch_on(SensorClock::time_point now);
  void switch_off();
  /// Switches on, too.
  void release_brakes(SensorClock::time_point now);
  [[nodiscard]] RobotMode mode(SensorClock::time_point now) const;

 private:
  mutable std::mutex mutex_;
  RobotMode goal_{RobotMode::Running};
  SensorClock::time_point booted_{}, released_{};
};

}  // namespace biteline::sim
