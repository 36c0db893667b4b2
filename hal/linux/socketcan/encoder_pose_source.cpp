// SPDX-License-Identifier: MIT
#include "hal/linux/socketcan/encoder_pose_source.hpp"

#include <thread>

namespace biteline::hal {
namespace {

/// An encoder sends at most once a millisecond.
constexpr std::chrono::microseconds k_look{500};

}  // namespace

Result<void> EncoderPoseSource::start() {
  if (state_ != PoseState::Idle) return fail(Errc::WrongState, "encoder pose source is started");
  last_stamp_ = clock_.now();
  state_ = PoseState::Connecting;
  return {};
}

Result<RobotPose> EncoderPoseSource::next_pose(Nanoseconds timeout) {
  if (state_ == PoseState::Idle) return fail(Errc::WrongState, "encoder pose source is not started");
  const SensorClock::time_point deadline = clock_.now() + timeout;
  while (true) {
    const Result<EncoderReading> reading = encoder_->read();
    if (!reading && reading.error().code != Errc::Timeout) return tl::unexpected<Error>{reading.error()};
    if (reading && reading->stamp > last_stamp_) {
      last_stamp_ = reading->stamp;
      rejected_ = reading->errors;
      if (state_ == PoseState::Lost) reconnects_.fetch_add(1);
      state_ = PoseState::Streaming;
      const Twist way = static_cast<double>(reading->position_ticks) * config_.per_tick;
      return RobotPose{.stamp = RobotClock::time_point{reading->stamp.time_since_epoch()},
                       .stamp_sensor = reading->stamp,
                       .received = reading->stamp,
                       .T_base_flange = geometry::exp_se3(way) * config_.T_base_flange_start,
                       .sequence = poses_.fetch_add(1),
                       .encoder_ticks = reading->position_ticks};
    }
    const SensorClock::time_point now = clock_.now();
    if (state_ == PoseState::Streaming && now - last_stamp_ > config_.lost_after) state_ = PoseState::Lost;
    if (now >= deadline) return fail(Errc::Timeout, "encoder pose");
    std::this_thread::sleep_for(k_look);
  }
}

Result<void> EncoderPoseSource::stop() {
  state_ = PoseState::Idle;
  return {};
}

PoseHealth EncoderPoseSource::health() const noexcept {
  return {.state = state_.load(),
          .poses = poses_.load(),
          .poses_rejected = rejected_.load(),
          .reconnects = reconnects_.load()};
}

}  // namespace biteline::hal
