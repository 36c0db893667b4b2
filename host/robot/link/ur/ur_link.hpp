// SPDX-License-Identifier: MIT
#pragma once
/// \file A UR controller: states over RTDE, programs over the script port, stop over its door.

#include <atomic>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "host/robot/link/robot_link.hpp"
#include "host/robot/link/state_age.hpp"
#include "host/robot/link/ur/controller_door.hpp"
#include "host/robot/link/ur/flow_script.hpp"
#include "host/robot/link/ur/remote_control.hpp"
#include "host/robot/link/ur/tcp_stream.hpp"

namespace biteline::rtde {
class ClientSession;
}

namespace biteline::robot::ur {

class ArmClaim;

/// Reads states at the controller's own rate on one thread; when the connection breaks it comes back by
/// itself and sends the recipe again.  A path is turned into URScript and sent only while the newest state
/// allows it. Memory: a recording grows to ten minutes at 500 Hz (about 120 MB) and then stops growing.
class UrLink final : public RobotLink {
 public:
  struct Config {
    std::string host{"127.0.0.1"};
    std::uint16_t rtde_port{30004};
    /// Of the primary interface: the secondary one (30002) takes programs, too, and never says why it does
    /// not run one.
    std::uint16_t script_port{k_primary_port};
    std::uint16_t dashboard_port{k_dashboard_port};  ///< 0: it is not called there
    std::uint16_t robot_api_port{0};                 ///< of a PolyScope X; 0: it is not called there
    double rate_hz{0};                               ///< 0: the controller's own
    double connect_patience_s{2};
    /// Also asks for the payload.  A controller before 3.11 or 5.5.1 refuses the question: open() fails.
    bool ask_payload{false};
    /// Also asks for the force on the tool and for what a program that presses tells; no such program is sent
    /// without.  A controller before 3.9 or 5.3 refuses the question.
    bool ask_force{false};
    int flange_input{-1};  ///< standard analog input with a flange's reading; -1: none
    /// Holds the register of the dead man, and outlives this; nullptr: sent programs have none.
    ArmClaim* claim{nullptr};
  };

  /// Fails when the first connection does or is refused for good, and when no usable state comes in time;
  /// the reason is told.  Later connections are tried again and again.
  [[nodiscard]] static Result<std::unique_ptr<UrLink>> open(const Config& config);
  ~UrLink() override;
  UrLink(const UrLink&) = delete;
  UrLink& operator=(const UrLink&) = delete;

  [[nodiscard]] Result<RobotState> latest() const override;
  [[nodiscard]] Result<RobotState> wait_newer(std::uint64_t sequence, Nanoseconds patience) const override;
  [[nodiscard]] Result<void> send(const PermittedPath& path) override;
  [[nodiscard]] bool may_run() const override { return begun_; }
  [[nodiscard]] bool has_dead_man() const override { return dead_man_; }
  [[nodiscard]] Result<void> stop() override;
  void beat() override;
  [[nodiscard]] std::optional<bool> remote_control() override;
  void start_recording() override;
  [[nodiscard]] std::vector<RobotState> take_recording() override;
  [[nodiscard]] LinkStatus status() const override;

 private:
  class Reader;
  explicit UrLink(const Config& config)
      : config_{config},
        script_at_{config.host, config.script_port},
        door_{ControllerDoor::closed(places())} {}
  [[nodiscard]] DoorPlaces places() const;
  void run();
  [[nodiscard]] Result<void> serve_connection(rtde::ClientSession& session);
  [[nodiscard]] Result<void> wait_for_first_state();
  void publish(RobotState state);
  void note_unusable(const Error& why);
  void note_session(const rtde::ClientSession& session);
  void note_disconnected(const Error& error);

  Config config_;
  std::atomic<bool> stopping_{false};

  mutable std::mutex mutex_;                 ///< guards everything below
  mutable std::condition_variable changed_;  ///< a new state, a lost connection, the end
  RobotState state_;
  LinkStatus status_;
  bool running_{false};         ///< the hand-shake is done
  bool refused_{false};         ///< asking again would be answered the same
  std::optional<Error> fault_;  ///< why the last connection ended
  std::optional<Error> unusable_;
  StateAge age_;
  bool recording_{false};
  std::vector<RobotState> recorded_;

  [[nodiscard]] Result<std::optional<int>> dead_mans_register() const;

  void hear_script();
  void keep_script_open();

  // Only send(), stop(), beat() and remote_control().
  TcpStream script_;  ///< kept open: a program that must replace the path's is on its way at once
  std::vector<std::uint8_t> script_heard_;                 ///< and not read yet: a piece of a message
  HostClock::time_point script_lived_{}, script_tried_{};  ///< last seen open, and last called again
  Endpoint script_at_;                                     ///< once it was found: by number
  std::unique_ptr<ControllerDoor> door_;                   ///< for the word that stops the arm
  bool begun_{false};                                      ///< a path's first byte has left
  bool dead_man_{false};                                   ///< the sent program has one
  int stops_{0};                                           ///< since then
  ToolOutputs outputs_{};                                  ///< that the sent path switches on
  bool asked_{false};  ///< whether it is in remote control, and not answered yet
  HostClock::time_point asked_at_{};
  RemoteControl remote_;
  std::thread thread_;
};

}  // namespace biteline::robot::ur
