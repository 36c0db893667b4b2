// SPDX-License-Identifier: MIT
#pragma once
/// \file PoseSource on a CAN bus (POSE_FRAMES.md): poses latched at SYNC, stamped by our own controller.

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>

#include "common/canpose/assembler.hpp"
#include "common/rt/latest_value.hpp"
#include "hal/api/can_bus.hpp"
#include "hal/api/clock.hpp"
#include "hal/api/pose_source.hpp"
#include "hal/timing/clock_map.hpp"

namespace biteline::hal {

/// Over any CanBus, so it runs on the simulated one too.  Poses whose SYNC was not seen are placed by their
/// own stamps, through a map of the controller's clock that the SYNCs before them made.
class CanPoseSource final : public PoseSource {
 public:
  struct Config {
    std::uint32_t base_id{canpose::k_default_base_id};
    Nanoseconds lost_after{100'000'000};  ///< no pose for so long: Lost (12 poses at 125 Hz)
  };
  CanPoseSource(std::unique_ptr<CanBus> bus, const Clock& clock, const Config& config);

  [[nodiscard]] Result<void> start() override;
  [[nodiscard]] Result<RobotPose> next_pose(Nanoseconds timeout) override;
  [[nodiscard]] Result<void> stop() override;
  [[nodiscard]] PoseHealth health() const noexcept override;

 private:
  /// Checks, counts and converts; nothing: rejected.
  std::optional<RobotPose> accept(const canpose::AssembledPose& pose, SensorClock::time_point received);
  void note_silence();

  std::unique_ptr<CanBus> bus_;
  const Clock& clock_;
  Config config_;
  canpose::Assembler assembler_;
  ClockMap<RobotClock> clock_map_;
  rt::LatestValue<ClockHealth> clock_health_;
  std::optional<RobotClock::time_point> last_stamp_;
  std::optional<std::uint64_t> last_sequence_;
  SensorClock::time_point last_pose_at_;
  std::atomic<PoseState> state_{PoseState::Idle};
  std::atomic<std::uint64_t> poses_{0};
  std::atomic<std::uint64_t> poses_lost_{0};
  std::atomic<std::uint64_t> poses_rejected_{0};
  std::atomic<std::uint64_t> reconnects_{0};
  std::atomic<std::uint64_t> poses_unlatched_{0};
};

}  // namespace biteline::hal
