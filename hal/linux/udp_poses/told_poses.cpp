// SPDX-License-Identifier: MIT
#include "hal/linux/udp_poses/told_poses.hpp"

#include <algorithm>
#include <utility>

namespace biteline::hal {

std::optional<RobotPose> ToldPoses::accept(const ToldPose& told, SensorClock::time_point received) {
  if (std::exchange(silent_, false) && last_ && told.stamp < last_->stamp) {
    last_.reset();
    clock_ = ClockMap<RobotClock>{};
  }
  if (last_ && told.stamp <= last_->stamp) {
    ++rejected_;
    // What is told again says nothing about the clock: a controller that stands still is not set back.
    if (told.stamp < last_->stamp && clock_.add(told.stamp, received) == ClockMapCore::Verdict::Stepped)
      last_.reset();
    return std::nullopt;
  }
  const std::uint64_t steps = last_ ? steps_to(told) : 1;
  last_ = told;
  sequence_ += steps;
  lost_ += steps - 1;
  ++poses_;
  clock_.add(told.stamp, received);
  return RobotPose{.stamp = told.stamp,
                   .stamp_sensor = clock_.to_sensor(told.stamp),
                   .received = received,
                   .T_base_flange = told.T_base_flange,
                   .sequence = sequence_,
                   .status = told.status};
}

std::uint64_t ToldPoses::steps_to(const ToldPose& told) {
  if (told.number && last_->number) {
    constexpr std::uint32_t k_half = 1U << 31U;
    const std::uint32_t steps = *told.number - *last_->number;
    return steps == 0 || steps >= k_half ? 1 : steps;  // counted anew: how many were lost nobody knows
  }
  const Nanoseconds step = told.stamp - last_->stamp;
  period_ = std::min(period_, step);
  return static_cast<std::uint64_t>((step + period_ / 2) / period_);
}

}  // namespace biteline::hal
