// SPDX-License-Identifier: MIT
#pragma once
/// \file Where the arm's flange is: from the robot controller, a pose bus, or a recording.

#include <cstdint>
#include <optional>

#include "common/core/result.hpp"
#include "common/geometry/se3.hpp"
#include "common/time/clocks.hpp"
#include "hal/api/clock_health.hpp"

namespace biteline::hal {

/// What the controller says about itself with a pose.
enum PoseStatus : std::uint32_t {
  k_pose_protective_stop = 1U << 0U,
  k_pose_emergency_stop = 1U << 1U,
  k_pose_program_running = 1U << 2U,
  k_pose_simulated = 1U << 3U,
};

struct RobotPose {
  RobotClock::time_point stamp;  ///< the controller's own instant of the pose
  /// The same instant on the sensor's clock, where the backend knows it (bus stamped by our own controller,
  /// PTP); otherwise the user maps `stamp` with the calibrated offset.
  std::optional<SensorClock::time_point> stamp_sensor;
  SensorClock::time_point received;  ///< when it arrived here
  SE3 T_base_flange{SE3::Identity()};
  std::uint64_t sequence{0};                    ///< gaps are losses
  std::uint32_t status{0};                      ///< PoseStatus
  std::optional<std::int64_t> encoder_ticks{};  ///< where an encoder is the pose: ticks since it was opened
};

enum class PoseState {
  Idle,        ///< not started
  Connecting,  ///< started, no pose yet
  Streaming,
  Lost,      ///< was streaming; connecting again by itself
  Finished,  ///< a finite source (a recording) has no further pose
};

struct PoseHealth {
  PoseState state{PoseState::Idle};
  std::uint64_t poses{0};
  std::uint64_t poses_lost{0};      ///< gaps in the source's own count
  std::uint64_t poses_rejected{0};  ///< not finite, no rotation, stamp not rising
  std::uint64_t reconnects{0};
  std::uint64_t poses_unlatched{0};  ///< no SYNC seen: placed by their own stamps and the clock's map
  std::uint64_t bus_errors{0};       ///< of a pose bus
  std::uint64_t bus_restarts{0};     ///< its returns from bus-off
  ClockHealth clock{};               ///< the controller's
};

/// | state                | start      | next_pose          | stop |
/// |----------------------|------------|--------------------|------|
/// | Idle                 | Connecting | refused            | Idle |
/// | Connecting, Lost     | refused    | Streaming, or Timeout | Idle |
/// | Streaming            | refused    | Streaming, or Timeout, Lost | Idle |
/// | Finished             | refused    | Timeout at once    | Idle |
///
/// refused: Errc::WrongState.  Stamps given out rise strictly; what does not is rejected and counted.
/// Thread: one owner; health() from any.  RT: waits in the kernel, allocates nothing after start().
class PoseSource {
 public:
  PoseSource() = default;
  PoseSource(const PoseSource&) = delete;
  PoseSource& operator=(const PoseSource&) = delete;
  virtual ~PoseSource() = default;

  [[nodiscard]] virtual Result<void> start() = 0;
  [[nodiscard]] virtual Result<RobotPose> next_pose(Nanoseconds timeout) = 0;
  [[nodiscard]] virtual Result<void> stop() = 0;
  [[nodiscard]] virtual PoseHealth health() const noexcept = 0;
  /// Why no pose comes, where the source knows more than that none came in time.  Thread: the owner's.
  [[nodiscard]] virtual std::optional<Error> fault() const { return std::nullopt; }
};

}  // namespace biteline::hal
