// SPDX-License-Identifier: MIT
#include "hal/sim/robot/power.hpp"

#include <algorithm>

namespace biteline::sim {
namespace {

constexpr Nanoseconds k_boots{150'000'000}, k_releases{150'000'000};

}  // namespace

void Power::set(bool on) {
  const std::lock_guard lock(mutex_);
  goal_ = on ? RobotMode::Running : RobotMode::PowerOff;
  booted_ = released_ = {};
}

void Power::switch_on(SensorClock::time_point now) {
  const std::lock_guard lock(mutex_);
  if (goal_ != RobotMode::PowerOff) return;
  goal_ = RobotMode::Idle;
  booted_ = now + k_boots;
}

void Power::switch_off() {
  set(false);
}

void Power::release_brakes(SensorClock::time_point now) {
  switch_on(now);
  const std::lock_guard lock(mutex_);
  if (goal_ == RobotMode::Running) return;
  goal_ = RobotMode::Running;
  released_ = std::max(now, booted_) + k_releases;
}

RobotMode Power::mode(SensorClock::time_point now) const {
  const std::lock_guard lock(mutex_);
  if (goal_ == RobotMode::PowerOff) return goal_;
  if (now < booted_) return RobotMode::Booting;
  return goal_ == RobotMode::Running && now >= released_ ? goal_ : RobotMode::Idle;
}

}  // namespace biteline::sim
