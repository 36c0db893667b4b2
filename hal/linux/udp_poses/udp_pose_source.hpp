// SPDX-License-Identifier: MIT
#pragma once
/// \file PoseSource that hears a robot controller's datagrams: ABB EGM, KUKA RSI.

#include <netinet/in.h>

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "hal/api/pose_source.hpp"
#include "hal/linux/posix/descriptor.hpp"
#include "hal/linux/udp_poses/told_poses.hpp"
#include "hal/timing/published_poses.hpp"

namespace biteline::hal {

/// Everything happens within next_pose(): no thread.  The controller speaks first, and only to who is set up
/// there.  Heard is one address; its port is that of the first message that can be read, until it is silent.
/// What others say is dropped and counted as rejected, as is what cannot be read.  Who can forge both address
/// and port is believed: the controller needs a network of its own.
/// stamp_sensor is the controller's stamp through the measured clock map; what stays is the constant part of
/// the delay, which the calibrated pose_clock_offset takes up.
class UdpPoseSource final : public PoseSource {
 public:
  enum class Language {
    Egm,  ///< nothing is answered: the controller streams
    Rsi,  ///< each message is answered at once, where answers are wanted
  };
  struct Config {
    Language language{Language::Egm};
    std::string controller{"127.0.0.1"};  ///< numeric IPv4
    std::uint16_t port{0};                ///< ours, where it is heard; 0: a free one
    bool answers{true};                   ///< Rsi; false: as ONLYSEND TRUE of the controller wants it
    Nanoseconds lost_after{100'000'000};  ///< 8 poses of 12 ms
  };
  /// Errc::BadValue: the address is no IPv4 address.
  [[nodiscard]] static Result<std::unique_ptr<UdpPoseSource>> open(const Config& config);

  /// Errc::DeviceError and others of the kernel: the port is taken, or is not ours to take.
  [[nodiscard]] Result<void> start() override;
  [[nodiscard]] Result<RobotPose> next_pose(Nanoseconds timeout) override;
  [[nodiscard]] Result<void> stop() override;
  [[nodiscard]] PoseHealth health() const noexcept override { return published_.health(); }
  /// Why what came was no pose; nothing once poses come again.
  [[nodiscard]] std::optional<Error> fault() const override { return last_fault_; }

  /// Where it is heard; 0 while not started.
  [[nodiscard]] std::uint16_t port() const { return bound_port_; }

 private:
  UdpPoseSource(const Config& config, const in_addr& controller) : config_{config}, controller_{controller} {}

  struct Message {
    std::span<const std::uint8_t> bytes;
    sockaddr_in sender{};
  };
  /// What has arrived; nothing: nothing has.
  [[nodiscard]] std::optional<Message> receive();
  /// Nothing: no pose, the reason in last_fault_.
  [[nodiscard]] std::optional<RobotPose> take(const Message& message);
  [[nodiscard]] bool is_controller(const sockaddr_in& sender) const;
  void answer(RobotClock::time_point stamp, const sockaddr_in& sender) const;
  void note_silence(SensorClock::time_point now);
  void publish_counts();

  Config config_;
  in_addr controller_;
  Descriptor socket_;
  std::uint16_t bound_port_{0};
  ToldPoses told_;
  std::optional<in_port_t> peer_port_;  ///< the controller's, network order
  SensorClock::time_point last_pose_at_;
  std::optional<Error> last_fault_;
  std::uint64_t unreadable_{0};
  std::array<std::uint8_t, 4096> buffer_{};
  PublishedPoses published_;
};

}  // namespace biteline::hal
