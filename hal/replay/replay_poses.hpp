// SPDX-License-Identifier: MIT
#pragma once
/// \file A recorded session's poses as a pose source.

#include <atomic>
#include <memory>

#include "common/session/session.hpp"
#include "hal/api/pose_source.hpp"

namespace biteline::hal::replay {

/// Gives every pose in order, at once when asked: the user paces it by the frames it goes with.
class ReplayPoses final : public PoseSource {
 public:
  explicit ReplayPoses(std::shared_ptr<const session::Session> session) : session_{std::move(session)} {}

  [[nodiscard]] Result<void> start() override;
  [[nodiscard]] Result<RobotPose> next_pose(Nanoseconds timeout) override;
  [[nodiscard]] Result<void> stop() override;
  [[nodiscard]] PoseHealth health() const noexcept override;

 private:
  std::shared_ptr<const session::Session> session_;
  std::atomic<bool> started_{false};
  std::atomic<std::size_t> next_{0};
};

}  // namespace biteline::hal::replay
