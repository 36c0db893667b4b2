// SPDX-License-Identifier: MIT
#pragma once
/// \file The part of URScript that path programs use, read into steps; anything else is refused with its
/// line.

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "common/core/result.hpp"
#include "common/geometry/se3.hpp"
#include "hal/sim/robot/arm_kinematics.hpp"
#include "hal/sim/robot/script_code.hpp"

namespace biteline::sim {

/// Units ours: mm, rad, s.
struct MoveStep {
  enum class Kind { Linear, Process, Joint };  ///< movel, movep, movej
  Kind kind{Kind::Linear};
  std::optional<SE3> T_base_tcp;     ///< the goal: a pose, or
  std::optional<JointVector> q_rad;  ///< joints
  double speed{0};                   ///< mm/s; movej: rad/s
  double acceleration{0};            ///< mm/s^2; movej: rad/s^2
  double blend_mm{0};
};
struct SetTcpStep {
  SE3 T_flange_tcp{SE3::Identity()};
};
/// What the arm carries, and where its centre of mass lies in the flange.
struct Payload {
  double mass_kg{0};
  Vec3 centre_mm{Vec3::Zero()};
};
struct SleepStep {
  double time_s{0};
};
struct DigitalOutStep {
  int number{0};  ///< 0 to 7: standard ones; 8 to 15: configurable ones; 16, 17: the tool's
  bool active{false};
};
struct AnalogOutStep {
  int number{0};
  double ratio{0};  ///< of its range
};
using OutputStep = std::variant<DigitalOutStep, AnalogOutStep>;
/// A variable of the program, for its threads.
struct AssignStep {
  std::string name;
  ScriptValue value{0.0};
};
struct TextStep {
  std::string text;
};
struct PopupStep {
  std::string text;
  bool blocking{false};  ///< the program waits until somebody closes it
};
/// The program asks for it, or wants to go where no arm of its size can: movel's end.
struct ProtectiveStopStep {
  bool out_of_reach{false};
};
/// What ends the program where it stands: movej has no joints for its goal.
struct FaultStep {
  std::string text;
};
struct RunThreadStep {
  std::string name;  ///< of the thread
};
struct KillThreadStep {
  std::string name;
};
struct WatchdogStep {
  std::string variable;  ///< an RTDE input
  double min_hz{0};
  bool stops{true};  ///< the program; else it is ignored
};
using ScriptStep = std::variant<MoveStep, SetTcpStep, Payload, SleepStep, DigitalOutStep, AnalogOutStep,
                                AssignStep, TextStep, PopupStep, ProtectiveStopStep, FaultStep, RunThreadStep,
                                KillThreadStep, WatchdogStep>;

struct Script {
  std::string name{"script"};
  std::vector<ScriptStep> steps;
  bool secondary{false};  ///< `sec`: runs beside the program that is on, and moves nothing
  std::vector<ScriptCode> threads{};
  std::optional<JointVector> start_rad{};  ///< where the arm's joints are when it begins, if known
};

/// `def name(): ... end` or bare lines; movel, movep, movej, set_tcp, set_payload, the digital and analog
/// outputs, sleep, sync, textmsg, popup, protective_stop; variables that hold literals, which threads see as
/// they are at that time; rtde_set_watchdog with "stop" or "ignore"; threads (script_code.hpp), run and
/// killed. Universal Robots, "The URScript Programming Language", with its defaults for a and v.  Loops,
/// conditions and expressions outside threads: program_text.hpp.
[[nodiscard]] Result<Script> parse_script(std::string_view text);

}  // namespace biteline::sim
