// SPDX-License-Identifier: MIT
#pragma once
/// \file An arm of any make behind the generic protocol: states, paths and the stop over one connection.

#include <atomic>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "common/arm_link/messages.hpp"
#include "host/robot/link/robot_link.hpp"
#include "host/robot/link/state_age.hpp"
#include "host/robot/link/ur/tcp_stream.hpp"

namespace biteline::robot::other {

/// Reads states on one thread; when the connection breaks it comes back by itself.  A path goes up whole, its
/// sum comes back, and only then the arm is told to go.  Its program ends by itself without beats or
/// connection.  Memory: a recording grows to ten minutes at 500 Hz and then stops growing.
class ArmLink final : public RobotLink {
 public:
  struct Config {
    std::string host{"127.0.0.1"};
    std::uint16_t port{arm_link::k_usual_port};
    double connect_patience_s{2};
    /// A controller that is away, or boots, is no failure of open(): it is called on and on.
    bool may_be_away{false};
  };
  /// Fails when no usable state comes in time, when the arm has not six joints, and with Errc::PeerRefused
  /// where another host is connected all the time.
  [[nodiscard]] static Result<std::unique_ptr<ArmLink>> open(const Config& config);
  ~ArmLink() override;
  ArmLink(const ArmLink&) = delete;
  ArmLink& operator=(const ArmLink&) = delete;

  /// What the controller says it is; nothing: not connected, or it has not said so.
  [[nodiscard]] std::optional<arm_link::Robot> robot() const;
  /// HOST:PORT
  [[nodiscard]] std::string address() const { return config_.host + ":" + std::to_string(config_.port); }

  [[nodiscard]] Result<RobotState> latest() const override;
  [[nodiscard]] Result<RobotState> wait_newer(std::uint64_t sequence, Nanoseconds patience) const override;
  /// Errc::CheckFailed: what came back of the path is not what was sent; nothing moves.
  [[nodiscard]] Result<void> send(const PermittedPath& path) override;
  [[nodiscard]] bool may_run() const override { return begun_; }
  [[nodiscard]] bool has_dead_man() const override { return true; }
  [[nodiscard]] Result<void> stop() override;
  void beat() override;
  /// The protocol has no such question.
  [[nodiscard]] std::optional<bool> remote_control() override { return std::nullopt; }
  void start_recording() override;
  [[nodiscard]] std::vector<RobotState> take_recording() override;
  [[nodiscard]] LinkStatus status() const override;

 private:
  using Stream = std::shared_ptr<ur::TcpStream>;
  explicit ArmLink(const Config& config) : config_{config} {}
  void run();
  [[nodiscard]] Result<void> serve_connection();
  /// Pre: what it takes for a connection of ours.
  void hear(const arm_link::Received& received);
  void publish(const arm_link::State& told);
  void note_connection(Stream stream);
  void note_disconnected(const Error& error);
  /// The next message; whole, or the connection is given up.
  [[nodiscard]] Result<void> say(const arm_link::Body& body, Nanoseconds patience);
  [[nodiscard]] Result<void> say_bytes(std::span<const std::uint8_t> bytes, Nanoseconds patience);
  [[nodiscard]] bool is_given_up(const Stream& stream) const;
  /// Its sum, as it left.
  [[nodiscard]] Result<std::uint32_t> upload(const path::CheckedPath& path, std::uint32_t name);
  [[nodiscard]] Result<arm_link::PathSum> wait_for_sum(std::uint32_t name) const;
  [[nodiscard]] Result<void> may_send(const PermittedPath& permitted) const;

  Config config_;
  std::atomic<bool> stopping_{false};

  mutable std::mutex mutex_;  ///< guards everything down to the thread
  mutable std::condition_variable changed_;
  Stream stream_;  ///< nullptr: none
  RobotState state_;
  LinkStatus status_;
  std::optional<arm_link::Robot> robot_;  ///< of this connection: before it no state counts
  std::optional<Error> fault_;
  std::optional<arm_link::PathSum> sum_;  ///< told since the last path's beginning
  std::optional<arm_link::Refusal> refusal_;
  StateAge age_;
  bool recording_{false};
  std::vector<RobotState> recorded_;

  std::mutex say_mutex_;    ///< one message after the other; before mutex_
  std::uint32_t said_{0};   ///< of this connection
  std::uint32_t paths_{0};  ///< names given
  std::atomic<bool> begun_{false};
  std::thread thread_;
};

}  // namespace biteline::robot::other
