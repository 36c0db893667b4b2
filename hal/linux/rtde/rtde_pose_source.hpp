// SPDX-License-Identifier: MIT
#pragma once
/// \file PoseSource on a UR controller's real-time port, connecting again by itself.

#include <array>
#include <memory>
#include <optional>
#include <string>

#include "common/rtde/client_session.hpp"
#include "hal/api/clock.hpp"
#include "hal/api/pose_source.hpp"
#include "hal/linux/rtde/rtde_samples.hpp"
#include "hal/linux/rtde/tcp_stream.hpp"
#include "hal/timing/published_poses.hpp"

namespace biteline::hal {

/// Everything happens within next_pose(): no thread.  A connection that fails, ends, says what it should not
/// or falls silent is given up and made anew, with the whole hand-shake, until stop(); Errc::Timeout then
/// says why.  A controller that lacks a variable or types it otherwise ends it: next_pose() gives its reason.
/// stamp_sensor is the
/// controller's stamp through the measured clock map; what stays is the constant part of the delay, which the
/// calibrated pose_clock_offset takes up.
class RtdePoseSource final : public PoseSource {
 public:
  struct Config {
    TcpStream::Peer controller{.address = "127.0.0.1", .port = 30004};
    RtdeSamples::Config samples{};
    Nanoseconds connect_timeout{2'000'000'000};  ///< hand-shake included
    Nanoseconds retry_after{250'000'000};
    Nanoseconds stale_after{100'000'000};        ///< 12 poses at 125 Hz: Lost, on the same connection
    Nanoseconds reconnect_after{1'000'000'000};  ///< a stall is waited for so long: a new one costs as much
  };
  [[nodiscard]] static Result<std::unique_ptr<RtdePoseSource>> open(const Config& config);

  [[nodiscard]] Result<void> start() override;
  [[nodiscard]] Result<RobotPose> next_pose(Nanoseconds timeout) override;
  [[nodiscard]] Result<void> stop() override;
  [[nodiscard]] PoseHealth health() const noexcept override { return published_.health(); }

  /// From the owner's thread.
  [[nodiscard]] ClockMapHealth clock_health() const { return samples_.clock_health(); }
  [[nodiscard]] std::optional<Error> fault() const override { return last_fault_; }
  /// Why the last connection ended; nothing once poses come again.
  [[nodiscard]] const std::optional<Error>& last_fault() const { return last_fault_; }

 private:
  explicit RtdePoseSource(const Config& config);

  void begin_connection(SensorClock::time_point now);
  void give_up(const Error& fault);
  /// One step of whatever the connection is at; waits no longer than to `until`.
  Result<void> advance(SensorClock::time_point until);
  void publish_counts();

  Config config_;
  RtdeSamples samples_;
  rtde::ClientSession session_;
  std::optional<TcpStream> stream_;
  bool handshaking_{false};
  bool made_anew_{false};  ///< the connection is not the first one with poses
  SensorClock::time_point connection_began_;
  SensorClock::time_point retry_at_;
  SensorClock::time_point last_data_;
  std::optional<Error> last_fault_;
  std::array<std::uint8_t, RtdeSamples::k_burst_bytes> received_bytes_{};
  PublishedPoses published_;
};

}  // namespace biteline::hal
