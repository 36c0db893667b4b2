// SPDX-License-Identifier: MIT
#pragma once
/// \file A UR controller that does nothing but answer, or what a test plays on it: RTDE, a script port that
/// keeps what it gets, a dashboard.

#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

namespace biteline::robot::test {

/// One state that is about to be sent, in the controller's units (m, rad).
struct PlayedState {
  double since_script_s{-1};  ///< by the controller's clock, since a whole script came; < 0: none yet
  bool stopped{false};        ///< it was told to stop
  int stop_programs{0};       ///< that came so far
  double time_s{0};           ///< the controller's clock
  std::array<double, 6> q{}, tcp_pose{0.5, -0.25, 0.125, 0, 3.0, 0}, tcp_offset{0, 0, 0.15, 0, 0, 0};
  std::int32_t robot_mode{7}, safety_mode{1};
  std::uint32_t runtime_state{1};
  double speed_scaling{1}, speed_slider{1};
  std::uint64_t outputs{0}, inputs{0};  ///< digital, as bits
  bool send{true};
  bool remote{true};  ///< its answer to "is in remote control"
  bool rests{false};  ///< after a stop the arm stands
  bool lie{false};    ///< the first state that a host must not accept
};

class FakeController {
 public:
  using Clock = std::chrono::steady_clock;
  /// Changes what is sent; each cycle, on the controller's thread.
  using Play = std::function<void(PlayedState&)>;

  FakeController() : FakeController{Play{}, 0.002} {}
  /// `cycle_s`: how far the controller's own clock goes on each cycle of some 2 ms.
  FakeController(Play play, double cycle_s);
  ~FakeController();
  FakeController(const FakeController&) = delete;
  FakeController& operator=(const FakeController&) = delete;

  [[nodiscard]] std::uint16_t rtde_port() const { return rtde_port_; }
  [[nodiscard]] std::uint16_t script_port() const { return script_port_; }
  [[nodiscard]] std::uint16_t dashboard_port() const { return dashboard_port_; }

  std::atomic<std::int32_t> robot_mode{7};
  std::atomic<std::int32_t> safety_mode{1};
  std::atomic<std::uint32_t> runtime_state{1};
  std::atomic<std::uint64_t> digital_inputs{0};
  std::atomic<bool> silent{false};  ///< keeps connections but sends no data
  std::atomic<bool> not_a_number{false};
  std::atomic<bool> turning{false};  ///< its first joint, by 0.01 rad each state
  std::atomic<bool> drop{false};     ///< set to drop the RTDE connection once; cleared when done
  std::atomic<int> rtde_connections{0};
  std::atomic<int> noes{0};                   ///< times that it says it is in local control, though it is not
  std::atomic<bool> local_control{false};     ///< somebody at the pendant has taken it
  std::atomic<bool> mute_dashboard{false};    ///< takes words, answers none
  std::atomic<bool> refuse_dashboard{false};  ///< hears nothing that is said there
  std::atomic<bool> close_script{false};      ///< set to close the script connections once; cleared when done
  std::atomic<bool> shut_script{false};       ///< set to close them and to take no further one
  std::atomic<bool> stream_script{false};     ///< a state of some 1100 bytes each cycle on the script port
  std::atomic<int> script_connections{0};

  /// Once, on the script connection, on the next cycle.
  void say_on_script(std::vector<std::uint8_t> bytes);

  /// Answers of the dashboard by command; others: "Stopped".  Set before a link is opened.
  std::map<std::string, std::string> answers;

  /// When the first lie was sent, the words that stop the arm and its tool came, and the arm stood.
  struct Times {
    std::optional<Clock::time_point> lie, stop, output_off, rest;
    int stop_words{0}, stop_programs{0};
  };
  [[nodiscard]] Times times() const;

  [[nodiscard]] std::string script() const;
  [[nodiscard]] std::string dashboard() const;

 private:
  void serve();
  void read_script(int client);
  /// One who asks at the dashboard, and what has come of a line.
  struct Asker {
    int client;
    std::string heard;
  };
  /// false: it has gone.
  bool read_dashboard(Asker& asker);
  void answer(int client, const std::string& command);

  int rtde_listener_{-1}, script_listener_{-1}, dashboard_listener_{-1};
  std::uint16_t rtde_port_{0}, script_port_{0}, dashboard_port_{0};
  mutable std::mutex mutex_;
  std::string script_, dashboard_;
  std::vector<std::uint8_t> to_say_;
  Times times_;
  Play play_;
  double cycle_s_;
  bool remote_{true};  ///< its own thread only
  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

}  // namespace biteline::robot::test
