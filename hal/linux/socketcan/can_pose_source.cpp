// SPDX-License-Identifier: MIT
#include "hal/linux/socketcan/can_pose_source.hpp"

namespace biteline::hal {
namespace {

std::uint32_t status_of(std::uint8_t bits) {
  std::uint32_t status = 0;
  if ((bits & canpose::k_protective_stop) != 0) status |= k_pose_protective_stop;
  if ((bits & canpose::k_emergency_stop) != 0) status |= k_pose_emergency_stop;
  if ((bits & canpose::k_program_running) != 0) status |= k_pose_program_running;
  if ((bits & canpose::k_simulated) != 0) status |= k_pose_simulated;
  return status;
}

}  // namespace

CanPoseSource::CanPoseSource(std::unique_ptr<CanBus> bus, const Clock& clock, const Config& config)
    : bus_{std::move(bus)}, clock_{clock}, config_{config}, assembler_{config.base_id} {}

Result<void> CanPoseSource::start() {
  if (state_ != PoseState::Idle) return fail(Errc::WrongState, "CAN pose source is started");
  // The whole of id bits but the low two for the classic set; SYNC and the FD frame by themselves.
  const std::array filters{
      CanFilter{.id = canpose::k_sync_id, .mask = 0x7FF, .extended = false},
      CanFilter{.id = config_.base_id, .mask = 0x7FC, .extended = false},
      CanFilter{.id = config_.base_id + canpose::k_fd_id_offset, .mask = 0x7FF, .extended = false}};
  if (config_.base_id % canpose::k_classic_frames != 0 || config_.base_id + canpose::k_fd_id_offset > 0x7FF) {
    return fail(Errc::BadValue, "CAN pose base id 0x%x: a multiple of 4 below 0x7F8 expected",
                config_.base_id);
  }
  BITELINE_TRY(bus_->set_filters(filters));
  assembler_ = canpose::Assembler{config_.base_id};
  clock_map_ = ClockMap<RobotClock>{};
  last_stamp_.reset();
  last_sequence_.reset();
  last_pose_at_ = clock_.now();
  state_ = PoseState::Connecting;
  return {};
}

Result<RobotPose> CanPoseSource::next_pose(Nanoseconds timeout) {
  if (state_ == PoseState::Idle) return fail(Errc::WrongState, "CAN pose source is not started");
  const SensorClock::time_point deadline = clock_.now() + timeout;
  while (true) {
    const Result<CanFrame> frame = bus_->receive(deadline - clock_.now());
    if (!frame) {
      note_silence();
      return tl::unexpected<Error>{frame.error()};
    }
    // A SYNC whose instant is a guess latches nothing: its pose is placed by its own stamp.
    if (frame->stamp_estimated && frame->id == canpose::k_sync_id) continue;
    const std::optional<canpose::AssembledPose> pose =
        assembler_.feed(frame->id, std::span{frame->data}.first(frame->size_bytes), frame->received);
    if (!pose) {
      // A bus full of other frames must not keep us here.
      if (clock_.now() >= deadline) {
        note_silence();
        return fail(Errc::Timeout, "CAN pose");
      }
      continue;
    }
    if (const std::optional<RobotPose> sample = accept(*pose, frame->received)) return *sample;
  }
}

std::optional<RobotPose> CanPoseSource::accept(const canpose::AssembledPose& pose,
                                               SensorClock::time_point received) {
  if (last_sequence_) poses_lost_.fetch_add(pose.sequence - *last_sequence_ - 1);
  last_sequence_ = pose.sequence;
  if (pose.latched) {
    clock_map_.add(pose.stamp, *pose.latched);
    clock_health_.rt_store(clock_health(clock_map_.health()));
  } else {
    poses_unlatched_.fetch_add(1);
  }
  const bool rises = !last_stamp_ || pose.stamp > *last_stamp_;
  if ((pose.message.status & canpose::k_pose_invalid) != 0 || !rises) {
    poses_rejected_.fetch_add(1);
    note_silence();
    // A sender whose clock was set back, or that started anew: once it is Lost its new time is taken.
    if (!rises && state_ == PoseState::Lost) last_stamp_.reset();
    return std::nullopt;
  }
  last_stamp_ = pose.stamp;
  last_pose_at_ = received;
  if (state_ == PoseState::Lost) reconnects_.fetch_add(1);
  state_ = PoseState::Streaming;
  poses_.fetch_add(1);
  return RobotPose{.stamp = pose.stamp,
                   .stamp_sensor = pose.latched ? pose.latched : clock_map_.to_sensor(pose.stamp),
                   .received = received,
                   .T_base_flange = pose.message.T_base_flange,
                   .sequence = pose.sequence,
                   .status = status_of(pose.message.status)};
}

void CanPoseSource::note_silence() {
  if (state_ == PoseState::Streaming && clock_.now() - last_pose_at_ > config_.lost_after)
    state_ = PoseState::Lost;
}

Result<void> CanPoseSource::stop() {
  state_ = PoseState::Idle;
  return {};
}

PoseHealth CanPoseSource::health() const noexcept {
  const CanHealth bus = bus_->health();
  return {.state = state_.load(),
          .poses = poses_.load(),
          .poses_lost = poses_lost_.load(),
          .poses_rejected = poses_rejected_.load(),
          .reconnects = reconnects_.load(),
          .poses_unlatched = poses_unlatched_.load(),
          .bus_errors = bus.bus_errors,
          .bus_restarts = bus.restarts,
          .clock = clock_health_.rt_load().value_or(ClockHealth{})};
}

}  // namespace biteline::hal
