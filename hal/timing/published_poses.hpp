// SPDX-License-Identifier: MIT
#pragma once
/// \file What a pose source's owner thread tells others of it.

#include <atomic>

#include "common/rt/latest_value.hpp"
#include "hal/api/pose_source.hpp"

namespace biteline::hal {

/// Thread: one writes; state() and health() from any.
class PublishedPoses {
 public:
  void set(PoseState state) { state_ = state; }
  [[nodiscard]] PoseState state() const { return state_; }
  void add_reconnect() { reconnects_.fetch_add(1); }
  void publish(std::uint64_t poses, std::uint64_t lost, std::uint64_t rejected, const ClockHealth& clock) {
    poses_ = poses;
    lost_ = lost;
    rejected_ = rejected;
    clock_.rt_store(clock);
  }

  [[nodiscard]] PoseHealth health() const noexcept {
    return {.state = state_.load(),
            .poses = poses_.load(),
            .poses_lost = lost_.load(),
            .poses_rejected = rejected_.load(),
            .reconnects = reconnects_.load(),
            .clock = clock_.rt_load().value_or(ClockHealth{})};
  }

 private:
  std::atomic<PoseState> state_{PoseState::Idle};
  std::atomic<std::uint64_t> poses_{0}, lost_{0}, rejected_{0}, reconnects_{0};
  rt::LatestValue<ClockHealth> clock_;
};

}  // namespace biteline::hal
