// SPDX-License-Identifier: MIT
#pragma once
/// \file PoseSource that hears the states of the generic arm protocol, connecting again by itself.

#include <array>
#include <memory>
#include <optional>

#include "common/arm_link/messages.hpp"
#include "hal/api/pose_source.hpp"
#include "hal/linux/rtde/tcp_stream.hpp"
#include "hal/linux/udp_poses/told_poses.hpp"
#include "hal/timing/published_poses.hpp"

namespace biteline::hal {

/// Connects to the controller's port of states and says nothing there, ever: it cannot command.  Everything
/// happens within next_pose(): no thread.  A connection that fails, ends, tells anything but sound states or
/// falls silent is given up and made anew until stop(); Errc::Timeout then says why.
/// stamp_sensor is the controller's stamp through the measured clock map; what stays is the constant part of
/// the delay, which the calibrated pose_clock_offset takes up.
class ArmLinkPoseSource final : public PoseSource {
 public:
  struct Config {
    TcpStream::Peer controller{.address = "127.0.0.1", .port = arm_link::k_usual_pose_port};
    Nanoseconds retry_after{250'000'000};
    Nanoseconds lost_after{100'000'000};         ///< 12 states at 125 Hz: Lost, on the same connection
    Nanoseconds reconnect_after{1'000'000'000};  ///< without a state, also of a new connection
  };
  /// Errc::BadValue: the address is no IPv4 address.
  [[nodiscard]] static Result<std::unique_ptr<ArmLinkPoseSource>> open(const Config& config);

  [[nodiscard]] Result<void> start() override;
  [[nodiscard]] Result<RobotPose> next_pose(Nanoseconds timeout) override;
  [[nodiscard]] Result<void> stop() override;
  [[nodiscard]] PoseHealth health() const noexcept override { return published_.health(); }
  /// Why the last connection ended, or what came was no pose; nothing once poses come again.
  [[nodiscard]] std::optional<Error> fault() const override { return last_fault_; }

 private:
  explicit ArmLinkPoseSource(const Config& config) : config_{config} {}

  /// Of what has arrived; nothing: no more of it is a pose.
  [[nodiscard]] Result<std::optional<RobotPose>> take_arrived();
  [[nodiscard]] Result<std::optional<RobotPose>> take(const arm_link::Received& received);
  /// One step of whatever the connection is at; waits no longer than to `until`.
  [[nodiscard]] Result<void> advance(SensorClock::time_point until);
  void give_up(const Error& fault);
  void note_silence(SensorClock::time_point now);
  void publish_counts();

  Config config_;
  std::optional<TcpStream> stream_;
  arm_link::Reader reader_;
  ToldPoses told_;
  SensorClock::time_point retry_at_, received_at_, last_state_at_, last_pose_at_;
  std::optional<Error> last_fault_;
  std::uint64_t unreadable_{0};
  std::array<std::uint8_t, 32 * arm_link::k_message_bytes> buffer_{};
  PublishedPoses published_;
};

}  // namespace biteline::hal
