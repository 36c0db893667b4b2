// SPDX-License-Identifier: MIT
#pragma once
/// \file The robot as the host sees it: where it is, and "follow this checked path".

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/core/result.hpp"
#include "common/time/clocks.hpp"
#include "host/robot/link/gate/gate.hpp"

namespace biteline::robot {

enum class Safety {
  Normal,
  Reduced,
  Stopped
};  ///< Stopped: protective, safeguard or emergency stop, or a fault

struct RobotState {
  std::uint64_t sequence{0};         ///< counts up by one per state since the link was opened
  RobotClock::time_point sampled{};  ///< by the controller
  HostClock::time_point received{};
  double age_s{0};  ///< when it was received, beyond the youngest of this link (StateAge)
  kinematics::Joints q_rad{kinematics::Joints::Zero()};
  SE3 T_base_tcp{SE3::Identity()};
  SE3 T_flange_tcp{SE3::Identity()};
  bool powered{false};  ///< brakes off, ready to move
  bool program_running{false};
  Safety safety{Safety::Stopped};
  std::optional<path::Payload>
      payload{};          ///< as the controller has it; nothing: not asked, or too old to say
  double speed_ratio{0};  ///< of the programmed speed: the slider times the limits
  /// On the tool at its tip, N in base axes, by the arm's own sensor; nothing: not asked for.
  std::optional<Vec3> force_base_newton{};
  std::optional<double> flange_ratio{};  ///< of a flange's full force, as it reads it; nothing: not asked for
  int force_word{0};                 ///< what a program that presses tells (ur/force_script.hpp, ForceWord)
  std::uint64_t digital_outputs{0};  ///< bits, as they are at the controller's terminals

  [[nodiscard]] bool output_on(int number) const {
    return number >= 0 && ((digital_outputs >> static_cast<unsigned>(number)) & 1U) != 0;
  }
};

struct LinkStatus {
  bool connected{false};
  std::uint64_t connections{0};  ///< 1 after the first; more: reconnects
  std::uint64_t states{0};
  std::uint64_t unusable_states{0};   ///< arrived without numbers or with numbers that nobody can mean
  std::uint64_t unreadable_texts{0};  ///< texts of the controller that its protocol does not explain
  std::uint64_t unknown_packages{0};  ///< of kinds that its protocol does not have
  std::string last_error;             ///< of the last connection that failed
  std::string last_text;              ///< the controller's own last warning or error
  std::string program_error;          ///< its own words on why the program sent last does not run, or no more
  double stop_door_closed_s{0};       ///< for so long no program that switches a tool off could be sent
};

/// Order of calls: open (factory), then any; send() only while the state is fresh, powered, safe and no
/// program runs. Thread: any; one program at a time.
class RobotLink {
 public:
  virtual ~RobotLink() = default;

  /// The newest state.  Errc::PoseStale when none came for 200 ms, Errc::ConnectionLost without a connection.
  [[nodiscard]] virtual Result<RobotState> latest() const = 0;
  /// Waits for a state newer than `sequence`; Errc::Timeout.
  [[nodiscard]] virtual Result<RobotState> wait_newer(std::uint64_t sequence, Nanoseconds patience) const = 0;

  /// Starts the path's program.  Takes nothing but a path that the gate let through, and only while the arm
  /// stands where the gate saw it and nobody has said stop since the path's order.
  [[nodiscard]] virtual Result<void> send(const PermittedPath& path) = 0;
  /// A byte of a program has left since send() was called last: it may run, whatever send() said.
  [[nodiscard]] virtual bool may_run() const = 0;
  /// The sent program ends by itself, the tool off, where nobody watches it any more (ur/script.hpp).
  [[nodiscard]] virtual bool has_dead_man() const = 0;
  /// Ends the running program, the arm brakes, and switches off the output that the sent path switches on.
  /// Success: the words have left this machine; whether they did anything the states tell.
  [[nodiscard]] virtual Result<void> stop() = 0;
  /// The run is being watched: at each turn of the watch.  Thread: that of send() and stop().
  virtual void beat() = 0;

  /// As the controller last said, while a sent path may run: asked twice a second, never waited for. Nothing:
  /// it has not said, or does not know the question.  Thread: that of send() and stop().
  [[nodiscard]] virtual std::optional<bool> remote_control() = 0;

  /// Keeps every state from now on, up to ten minutes' worth; the recording is handed out once.
  virtual void start_recording() = 0;
  [[nodiscard]] virtual std::vector<RobotState> take_recording() = 0;

  [[nodiscard]] virtual LinkStatus status() const = 0;
};

}  // namespace biteline::robot
