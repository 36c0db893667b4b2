// SPDX-License-Identifier: MIT
#pragma once
/// \file A simulated UR controller on loopback: RTDE, script port, primary interface, dashboard or Robot API.

#include <array>
#include <atomic>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <thread>
#include <vector>

#include "hal/sim/robot/arm.hpp"
#include "hal/sim/robot/contact_flange.hpp"
#include "hal/sim/robot/dashboard.hpp"
#include "hal/sim/robot/force_control.hpp"
#include "hal/sim/robot/power.hpp"
#include "hal/sim/robot/robot_api.hpp"
#include "hal/sim/robot/script_runner.hpp"
#include "hal/sim/robot/tcp.hpp"
#include "hal/sim/robot/tool_turret.hpp"
#include "hal/sim/robot/ur_values.hpp"

namespace biteline::sim {

/// One thread serves all connections and the controller's cycle.  A script replaces the one that runs, as on
/// the real one; moves whose blends meet are skipped and warned of; of a script that cannot be read nothing
/// moves.  Both are said as robot messages to the clients of the primary port, and nowhere else.
///
/// A CB3 (software 3) or an e-Series (5) has a dashboard (dashboard.hpp), a PolyScope X (10) the Robot API
/// instead (robot_api.hpp).  Script port and primary port send version, kinematics and configuration to who
/// connects and the robot's mode ten times a second (primary_messages.hpp), and take scripts and words of
/// their own (program_text.hpp); who does not read there gets the newest state when it does.  The primary
/// port tells of programs, too.  What runs is in script_runner.hpp.  Thread: any for the public methods.
class UrController {
 public:
  struct Config {
    std::uint16_t rtde_port{0};            ///< 0: a free one; the real one has 30004
    std::uint16_t script_port{0};          ///< 30002
    std::uint16_t dashboard_port{0};       ///< 29999
    std::uint16_t robot_api_port{0};       ///< 80
    std::uint16_t primary_port{0};         ///< 30001
    int rate_hz{500};                      ///< 125: as a CB3
    Nanoseconds clock_offset{0};           ///< controller clock minus this machine's monotonic clock
    double speed_slider_ratio{1};          ///< where the pendant's slider stands at first
    std::array<int, 3> version{5, 12, 0};  ///< 3: a CB3, 5: an e-Series, 10: a PolyScope X
    std::string model{"UR5e"};
    std::string serial{"20235500001"};
    /// What dashboard and Robot API can load, by name: "wait.urp" or "wait", and the script it stands for.
    std::map<std::string, std::string> programs{};
    /// How long a protective stop must be looked at before a dashboard unlocks it.
    Nanoseconds unlocks_after{5'000'000'000};
    /// false: the setting "remote control" is off: it says that it is not in remote control, and takes all.
    bool remote_control_enabled{true};
    /// The force sensor and force mode of the arm, and what the tool meets; none: nothing.
    ForceFacts force{};
    Touch touch{};
    std::optional<TurretFacts> turret{};  ///< wired to its digital lines
    std::optional<FlangeFacts> flange{};  ///< between arm and tool: what touches, touches it
  };
  struct Ports {
    std::uint16_t rtde, script, dashboard, robot_api, primary;  ///< 0: it has none
  };
  /// Called on each cycle with the instant on this machine's monotonic clock, on the controller's thread; the
  /// state's joints are those told in target_q.
  using OnCycle = std::function<void(SensorClock::time_point, const ArmState&, const ArmReal&)>;

  [[nodiscard]] static Result<std::unique_ptr<UrController>> open(const Config& config, Arm& arm,
                                                                  OnCycle on_cycle);
  ~UrController();
  UrController(const UrController&) = delete;
  UrController& operator=(const UrController&) = delete;

  [[nodiscard]] Ports ports() const {
    return {rtde_listener_.port, script_listener_.port, dashboard_listener_.port, robot_api_listener_.port,
            primary_listener_.port};
  }
  /// What a person does at the pendant, and what the safety system does: the arm stops where it is and takes
  /// no program until it is let go.
  void set_remote_control(bool on) { remote_control_ = on; }
  void set_protective_stop(bool on) { protective_stop_ = on; }
  void set_powered(bool on) { power_.set(on); }
  /// The pendant's speed slider, 0 to 1: programs go at that share of their speed, after a ramp of half a
  /// second for the whole of it.  RTDE clients may set it, too.
  void set_speed_slider(double ratio) { slider_wish_ = ratio; }
  /// What a limit of the controller's own leaves of the speed, 0 to 1; told as speed_scaling.
  void set_speed_scaling(double ratio) { speed_scaling_ = ratio; }
  /// What is wired to a standard digital input, 0 to 7.
  void set_digital_input(int number, bool on) {
    const std::uint64_t bit = std::uint64_t{1} << static_cast<unsigned>(number);
    if (on) {
      digital_inputs_ |= bit;
    } else {
      digital_inputs_ &= ~bit;
    }
  }
  /// As a real one does when it goes to local control: it ends each connection to the script port.
  void close_script_connections() { close_scripts_ = true; }
  [[nodiscard]] std::uint64_t scripts_run() const { return scripts_run_.load(); }
  [[nodiscard]] std::uint64_t scripts_refused() const { return scripts_refused_.load(); }
  /// For blends that meet.
  [[nodiscard]] std::uint64_t moves_skipped() const { return moves_skipped_.load(); }
  /// Programs that a watchdog or a thread of their own ended.
  [[nodiscard]] std::uint64_t programs_cut() const { return programs_cut_.load(); }

 private:
  struct Client {
    hal::Descriptor socket;
    std::vector<std::uint8_t> incoming, outgoing;
    bool closing{false};  ///< as soon as all is sent
  };
  struct ScriptClient : Client {
    bool primary{false};    ///< gets robot messages, too
    bool state_due{false};  ///< it has not got the newest
  };
  struct RtdeClient : Client {
    explicit RtdeClient(const rtde::ControllerSession::Config& config) : session(config) {}
    rtde::ControllerSession session;
  };

  UrController(const Config& config, Arm& arm, OnCycle on_cycle);
  void serve();
  void cycle(std::uint64_t number);
  void set_arms_speed(SensorClock::time_point instant);
  void wait_until(SensorClock::time_point instant);
  static void pass_on(RtdeClient& client);
  void accept_clients();
  void serve_rtde();
  void serve_scripts();
  void serve_dashboard();
  void serve_robot_api();
  void take_program_text(const std::string& text);
  void run_script(const std::string& text);
  void run_loaded(const std::string& name);
  void pause(bool on);
  void stop_program();
  /// The arm takes programs: brakes released, nothing in the way.
  [[nodiscard]] bool takes_programs() const;
  /// Standard ones, as what is wired to them has them now.
  [[nodiscard]] std::uint64_t inputs_now() const;
  [[nodiscard]] ArmState arm_state(SensorClock::time_point instant) const;
  void run_program(SensorClock::time_point instant);
  [[nodiscard]] bool act(std::string_view function, std::span<const ScriptValue> arguments);
  void step_force(SensorClock::time_point instant);
  void watch_safety(SensorClock::time_point instant);
  void take(const ProgramNews& news);
  void send_states(std::uint64_t number, const ArmState& state);
  /// A robot message to who listens at the primary port.
  void tell(const std::vector<std::uint8_t>& message);
  [[nodiscard]] Nanoseconds stamp_now() const;
  [[nodiscard]] std::string dashboard_answer(const std::string& line, Client& client);
  [[nodiscard]] bool says_remote() const { return config_.remote_control_enabled && remote_control_; }
  [[nodiscard]] bool is_local() const { return config_.remote_control_enabled && !remote_control_; }
  [[nodiscard]] SensorClock::time_point instant_of(std::uint64_t cycle) const;

  Config config_;
  Arm& arm_;
  OnCycle on_cycle_;
  UrValues values_;
  ScriptRunner runner_;
  ForceControl force_;
  std::optional<ToolTurret> turret_;
  std::optional<ContactFlange> flange_;
  TcpListener rtde_listener_, script_listener_, dashboard_listener_, robot_api_listener_, primary_listener_;
  std::shared_ptr<rtde::InputOwners> input_owners_{std::make_shared<rtde::InputOwners>()};
  std::atomic<bool> remote_control_{true}, protective_stop_{false}, close_scripts_{false};
  Power power_;
  bool was_stopped_{false};  ///< protectively, on the last cycle
  SensorClock::time_point stopped_since_{};
  bool waits_for_popup_{false};
  bool plays_loaded_{false};  ///< the program that is on, or was last, is the dashboard's or the Robot API's
  dashboard::Memory dashboard_memory_;
  robot_api::Memory robot_api_memory_;
  std::atomic<double> slider_wish_{-1};  ///< negative: nobody has touched it
  std::atomic<double> speed_scaling_{1};
  std::atomic<std::uint64_t> digital_inputs_{0};
  std::uint64_t turret_inputs_{0};
  double pace_ratio_{1};  ///< the arm's, on its way to slider times scaling
  std::vector<std::unique_ptr<RtdeClient>> rtde_clients_;
  std::vector<std::unique_ptr<ScriptClient>> script_clients_;
  std::vector<std::unique_ptr<Client>> dashboard_clients_, robot_api_clients_;
  SensorClock::time_point begin_;
  std::uint64_t states_sent_{0};  ///< periods of the primary port
  std::atomic<std::uint64_t> scripts_run_{0}, scripts_refused_{0}, moves_skipped_{0}, programs_cut_{0};
  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

}  // namespace biteline::sim
