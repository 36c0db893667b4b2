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
#include "hal/sim/robot/thread_code.hpp"

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
  int number{0};
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
                                AssignStep, TextStep, RunThreadStep, KillThreadStep, WatchdogStep>;

struct Script {
  std::string name{"script"};
  std::vector<ScriptStep> steps;
  std::vector<ThreadCode> threads{};
  std::optional<JointVector> start_rad{};  ///< where the arm's joints are when it begins, if known
};

/// `def name(): ... end` or bare lines; movel, movep, movej, set_tcp, set_payload, set_digital_out,
/// set_standard_digital_out, set_standard_analog_out, sleep, sync, textmsg; variables that hold literals,
/// which threads see as they are at that time; rtde_set_watchdog with "stop" or "ignore"; threads
/// (thread_code.hpp), run and killed.  Universal Robots, "The URScript Programming Language", with its
/// defaults for a and v.  No loops and no conditions but in threads.
[[nodiscard]] Result<Script> parse_script(std::string_view text);

}  // namespace biteline::sim
