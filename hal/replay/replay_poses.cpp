// SPDX-License-Identifier: MIT
#include "hal/replay/replay_poses.hpp"

namespace biteline::hal::replay {

Result<void> ReplayPoses::start() {
  if (started_) return fail(Errc::WrongState, "recorded poses: started twice");
  next_ = 0;
  started_ = true;
  return {};
}

Result<RobotPose> ReplayPoses::next_pose(Nanoseconds) {
  if (!started_) return fail(Errc::WrongState, "recorded poses: next_pose before start");
  const std::size_t index = next_;
  if (index == session_->poses.size()) return fail(Errc::Timeout, "recorded poses are at their end");
  next_ = index + 1;
  const session::StampedPose& pose = session_->poses[index];
  const SensorClock::time_point stamp_sensor =
      to_sensor_clock(pose.stamp, session_->sensor.pose_clock_offset);
  return RobotPose{.stamp = pose.stamp,
                   .stamp_sensor = stamp_sensor,
                   .received = stamp_sensor,
                   .T_base_flange = pose.T_base_flange,
                   .sequence = index,
                   .status = 0,
                   .encoder_ticks = pose.encoder_ticks};
}

Result<void> ReplayPoses::stop() {
  started_ = false;
  return {};
}

PoseHealth ReplayPoses::health() const noexcept {
  PoseHealth health;
  health.poses = next_;
  if (!started_) {
    health.state = PoseState::Idle;
  } else if (next_ == session_->poses.size()) {
    health.state = PoseState::Finished;
  } else {
    health.state = next_ == 0 ? PoseState::Connecting : PoseState::Streaming;
  }
  return health;
}

}  // namespace biteline::hal::replay
