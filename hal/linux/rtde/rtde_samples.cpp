// SPDX-License-Identifier: MIT
#include "hal/linux/rtde/rtde_samples.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace biteline::hal {
namespace {

// Places in the recipe.
enum Field : std::size_t { k_timestamp, k_tcp_pose, k_tcp_offset, k_runtime_state, k_safety_bits };

// Universal Robots, RTDE Guide: runtime_state 2 = playing; safety_status_bits 2 protective stop, 5 system, 6
// robot and 7 any emergency stop.
constexpr std::uint32_t k_runtime_playing = 2;
constexpr std::uint32_t k_safety_protective = 1U << 2U;
constexpr std::uint32_t k_safety_emergency = 1U << 5U | 1U << 6U | 1U << 7U;

/// m and a rotation vector on the wire.
std::optional<SE3> to_motion(const rtde::Vector6& pose) {
  constexpr double k_mm_per_m = 1000;
  constexpr double k_reach_max_m = 100;  // no arm; what is beyond is no pose
  const bool sane = std::all_of(pose.begin(), pose.end(), [](double part) {
    return std::isfinite(part) && std::abs(part) < k_reach_max_m;
  });
  if (!sane) return std::nullopt;
  SE3 T = SE3::Identity();
  T.translation() = k_mm_per_m * Vec3{pose[0], pose[1], pose[2]};
  T.linear() = geometry::exp_so3({pose[3], pose[4], pose[5]});
  return T;
}

}  // namespace

rtde::ClientSession::OutputRecipe RtdeSamples::recipe(double rate_hz) {
  using enum rtde::FieldType;
  return {.variables = {{"timestamp", Double},
                        {"actual_TCP_pose", Vector6d},
                        {"tcp_offset", Vector6d},
                        {"runtime_state", Uint32},
                        {"safety_status_bits", Uint32}},
          .frequency_hz = rate_hz};
}

void RtdeSamples::on_data(std::size_t, std::span<const rtde::Value> values) {
  // The session let no other types through; a null pointer is refused all the same.
  const auto* const time_s = std::get_if<double>(&values[k_timestamp]);
  const auto* const tcp_pose = std::get_if<rtde::Vector6>(&values[k_tcp_pose]);
  const auto* const tcp_offset = std::get_if<rtde::Vector6>(&values[k_tcp_offset]);
  const auto* const runtime_state = std::get_if<std::uint32_t>(&values[k_runtime_state]);
  const auto* const safety_bits = std::get_if<std::uint32_t>(&values[k_safety_bits]);
  constexpr double k_time_max_s =
      4e9;  // 127 years: nanoseconds in 63 bits hold twice that, and so any difference to ours
  if (!time_s || !tcp_pose || !tcp_offset || !runtime_state || !safety_bits || !std::isfinite(*time_s) ||
      *time_s < 0 || *time_s > k_time_max_s) {
    ++counts_.poses_rejected;
    return;
  }
  const RobotClock::time_point stamp{Nanoseconds{std::llround(*time_s * 1e9)}};
  if (first_of_connection_ && last_stamp_ && stamp <= *last_stamp_) last_stamp_.reset();
  const std::optional<SE3> T_base_tcp = to_motion(*tcp_pose);
  const std::optional<SE3> T_flange_tcp = to_motion(*tcp_offset);
  if (!T_base_tcp || !T_flange_tcp || (last_stamp_ && stamp <= *last_stamp_)) {
    ++counts_.poses_rejected;
    // The clock map sees the jump too; once it began anew, so do the stamps.
    if (clock_.add(stamp, received_) == ClockMapCore::Verdict::Stepped) last_stamp_.reset();
    return;
  }
  std::uint64_t steps = 1;
  if (last_stamp_) {
    const Nanoseconds step = stamp - *last_stamp_;
    // The way over a broken connection says nothing about the period.
    if (!first_of_connection_) keep_step(step);
    const double cycles = static_cast<double>(step.count()) / static_cast<double>(period().count());
    steps = static_cast<std::uint64_t>(std::max(1.0, std::min(std::round(cycles), 1e9)));
  }
  last_stamp_ = stamp;
  if (std::exchange(first_of_connection_, false)) steps_ = {};
  sequence_ += steps;
  counts_.poses_lost += steps - 1;
  clock_.add(stamp, received_);

  std::uint32_t status = 0;
  if (*runtime_state == k_runtime_playing) status |= k_pose_program_running;
  if ((*safety_bits & k_safety_protective) != 0) status |= k_pose_protective_stop;
  if ((*safety_bits & k_safety_emergency) != 0) status |= k_pose_emergency_stop;
  put(RobotPose{.stamp = stamp,
                .stamp_sensor = clock_.to_sensor(stamp),
                .received = received_,
                .T_base_flange = *T_base_tcp * T_flange_tcp->inverse(),
                .sequence = sequence_,
                .status = status});
}

void RtdeSamples::keep_step(Nanoseconds step) {
  steps_[next_step_] = step;
  next_step_ = (next_step_ + 1) % k_steps_kept;
}

Nanoseconds RtdeSamples::period() const {
  Nanoseconds least = Nanoseconds::max();
  for (const Nanoseconds step : steps_) {
    if (step > Nanoseconds{0}) least = std::min(least, step);
  }
  const Nanoseconds wished{std::llround(1e9 / config_.rate_hz)};
  return least == Nanoseconds::max() ? wished : std::max(least, wished);
}

void RtdeSamples::put(const RobotPose& sample) {
  if (count_ == k_waiting) {
    first_ = (first_ + 1) % k_waiting;
    --count_;
    ++counts_.poses_lost;
  }
  waiting_[(first_ + count_) % k_waiting] = sample;
  ++count_;
}

std::optional<RobotPose> RtdeSamples::take() {
  if (count_ == 0) return std::nullopt;
  const RobotPose sample = waiting_[first_];
  first_ = (first_ + 1) % k_waiting;
  --count_;
  ++counts_.poses;
  return sample;
}

}  // namespace biteline::hal
