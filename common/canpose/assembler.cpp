// SPDX-License-Identifier: MIT
#include "common/canpose/assembler.hpp"

#include <algorithm>
#include <chrono>

namespace biteline::canpose {
namespace {

/// Steps from one counter to a later one on the ring 1..240.
unsigned steps_between(std::uint8_t from, std::uint8_t to) {
  return (to + k_sync_counter_last - from) % k_sync_counter_last;
}

bool is_counter(std::uint8_t counter) {
  return counter >= 1 && counter <= k_sync_counter_last;
}

}  // namespace

std::optional<AssembledPose> Assembler::feed(std::uint32_t id, std::span<const std::uint8_t> data,
                                             SensorClock::time_point received) {
  if (id == k_sync_id) {
    on_sync(data, received);
    return std::nullopt;
  }
  if (id == base_id_ + k_fd_id_offset) {
    const Result<PoseMessage> message = decode_fd(data);
    if (!message) {
      ++health_.frames_refused;
      return std::nullopt;
    }
    return complete(*message, false);
  }
  if (id >= base_id_ && id < base_id_ + k_classic_frames) return on_classic(id - base_id_, data);
  return std::nullopt;
}

void Assembler::on_sync(std::span<const std::uint8_t> data, SensorClock::time_point received) {
  // A SYNC without counter (CiA 301 allows it) ties to no pose: two of them cannot be told apart.
  if (data.size() != 1 || !is_counter(data[0])) {
    ++health_.frames_refused;
    return;
  }
  ++health_.syncs;
  if (last_sync_counter_ != 0) {
    const unsigned steps = steps_between(last_sync_counter_, data[0]);
    // 0 steps: the same counter again, which is a whole turn lost or a doubled SYNC; both lose count of one.
    health_.syncs_missed += steps == 0 ? 1 : steps - 1;
  }
  last_sync_counter_ = data[0];
  last_sync_ = received;
}

std::optional<AssembledPose> Assembler::on_classic(std::size_t index, std::span<const std::uint8_t> data) {
  if (data.size() != k_classic_size_bytes) {
    ++health_.frames_refused;
    pending_count_ = 0;
    return std::nullopt;
  }
  // CAN keeps the order of one sender's frames of rising id; anything else is a frame lost or doubled.
  const bool in_order = index == pending_count_ && (index == 0 || data[0] == pending_[0][0]);
  if (!in_order) {
    if (pending_count_ != 0) count_incomplete(pending_[0][0]);
    pending_count_ = 0;
    if (index != 0) {
      count_incomplete(data[0]);
      return std::nullopt;
    }
  }
  std::copy(data.begin(), data.end(), pending_[index].begin());
  ++pending_count_;
  if (pending_count_ < k_classic_frames) return std::nullopt;

  pending_count_ = 0;
  const Result<PoseMessage> message = decode_classic(pending_);
  if (!message) {
    ++health_.frames_refused;
    return std::nullopt;
  }
  return complete(*message, true);
}

void Assembler::count_incomplete(std::uint8_t counter) {
  if (counter == last_incomplete_counter_) return;
  last_incomplete_counter_ = counter;
  ++health_.poses_incomplete;
}

std::optional<AssembledPose> Assembler::complete(const PoseMessage& message, bool stamp_is_32_bit) {
  const unsigned steps =
      last_pose_counter_ == 0 ? 1 : steps_between(last_pose_counter_, message.sync_counter);
  if (steps == 0) return std::nullopt;  // the other form of the pose already given
  last_pose_counter_ = message.sync_counter;
  sequence_ += steps;

  AssembledPose pose{.message = message,
                     .stamp = unwrapped(message.stamp_us, stamp_is_32_bit),
                     .latched = std::nullopt,
                     .sequence = sequence_};
  if (message.sync_counter == last_sync_counter_) {
    pose.latched = last_sync_;
  } else {
    ++health_.poses_without_sync;
  }
  ++health_.poses;
  return pose;
}

RobotClock::time_point Assembler::unwrapped(std::uint64_t stamp_us, bool is_32_bit) {
  std::uint64_t full_us = stamp_us;
  if (is_32_bit && last_stamp_us_) {
    // The nearest continuation: half of the 71 minutes' turn forwards or backwards.
    const auto step_us = static_cast<std::int32_t>(static_cast<std::uint32_t>(stamp_us) -
                                                   static_cast<std::uint32_t>(*last_stamp_us_));
    full_us = *last_stamp_us_ + static_cast<std::uint64_t>(static_cast<std::int64_t>(step_us));
  }
  last_stamp_us_ = full_us;
  return RobotClock::time_point{Nanoseconds{static_cast<std::int64_t>(full_us * 1000)}};
}

}  // namespace biteline::canpose
