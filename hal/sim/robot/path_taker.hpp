// SPDX-License-Identifier: MIT
#pragma once
/// \file A made controller that speaks the generic arm protocol, with the simulated arm behind it.

#include <atomic>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "common/arm_link/messages.hpp"
#include "hal/sim/robot/arm.hpp"
#include "hal/sim/robot/state_teller.hpp"
#include "hal/sim/robot/tcp.hpp"

namespace biteline::sim {

/// What docs/other-arms.md asks of the program on a controller, on loopback; made, no make's own.  One host
/// at a time, and beside it listeners at a port of their own.  One thread serves the connection and the
/// cycle.  Thread: any for the public methods.
class PathTaker {
 public:
  struct Config {
    std::uint16_t port{0};       ///< 0: a free one
    std::uint16_t pose_port{0};  ///< likewise
    int rate_hz{250};
    Nanoseconds clock_offset{0};  ///< controller clock minus this machine's monotonic clock
    arm_link::Robot robot{.make = "made", .model = "UR5e by another name", .serial = "1", .joints = 6};
    /// A controller that loses a bit of what it was sent: the path's sum is another one.
    bool spoils_paths{false};
    Nanoseconds path_age_max{arm_link::k_path_age_max};
  };
  [[nodiscard]] static Result<std::unique_ptr<PathTaker>> open(const Config& config, Arm& arm);
  ~PathTaker();
  PathTaker(const PathTaker&) = delete;
  PathTaker& operator=(const PathTaker&) = delete;

  [[nodiscard]] std::uint16_t port() const { return listener_.port; }
  [[nodiscard]] std::uint16_t pose_port() const { return teller_->port(); }
  void set_safe(bool on) { safe_ = on; }
  void set_powered(bool on) { powered_ = on; }
  /// Of the way that a program ended before its end, the last.
  [[nodiscard]] arm_link::Fault fault() const { return fault_; }
  [[nodiscard]] std::uint64_t paths_run() const { return paths_run_; }
  [[nodiscard]] std::uint64_t messages_refused() const { return messages_refused_; }

 private:
  PathTaker(const Config& config, Arm& arm) : config_{config}, arm_{arm} {}
  void serve();
  void accept_host(SensorClock::time_point now);
  void hear(SensorClock::time_point now);
  [[nodiscard]] arm_link::Reason take(const arm_link::Received& received, const arm_link::Message& message,
                                      SensorClock::time_point now);
  [[nodiscard]] arm_link::Reason take_begin(const arm_link::PathBegin& begin,
                                            const arm_link::Message& message);
  [[nodiscard]] arm_link::Reason take_point(const arm_link::PathPoint& point,
                                            const arm_link::Message& message);
  [[nodiscard]] arm_link::Reason take_end(const arm_link::PathEnd& end, SensorClock::time_point now);
  [[nodiscard]] arm_link::Reason go(const arm_link::Go& go, SensorClock::time_point now);
  void halt(arm_link::Fault fault, SensorClock::time_point now);
  void watch(SensorClock::time_point now);
  void say(const arm_link::Body& body);
  void lose_host(SensorClock::time_point now);
  [[nodiscard]] arm_link::State state_at(SensorClock::time_point now);
  [[nodiscard]] Script script() const;

  Config config_;
  Arm& arm_;
  TcpListener listener_;
  std::optional<StateTeller> teller_;
  std::atomic<bool> safe_{true}, powered_{true}, stopping_{false};
  std::atomic<arm_link::Fault> fault_{arm_link::Fault::None};
  std::atomic<std::uint64_t> paths_run_{0}, messages_refused_{0};

  // Only the thread.
  hal::Descriptor host_;
  std::vector<std::uint8_t> outgoing_;
  arm_link::Reader reader_;
  std::uint32_t said_{0};
  SensorClock::time_point beat_at_;  ///< or when the host came
  bool heard_{false};                ///< the host has said a word
  arm_link::Phase phase_{arm_link::Phase::Idle};
  arm_link::PathBegin path_;
  std::vector<arm_link::PathPoint> points_;
  arm_link::Sum sum_;
  SensorClock::time_point whole_at_;
  std::size_t nearest_{0};
  std::optional<JointVector> q_rad_{};  ///< followed from pose to pose
  std::thread thread_;
};

}  // namespace biteline::sim
