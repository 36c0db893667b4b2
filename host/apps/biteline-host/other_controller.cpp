// SPDX-License-Identifier: MIT
#include "host/apps/biteline-host/other_controller.hpp"

#include "host/robot/kinematics/chain.hpp"
#include "host/robot/link/follow.hpp"

namespace biteline::service {
namespace {

/// Why the newest state is none: the connection's own reason says more than that there is none.
Result<robot::RobotState> newest(const robot::other::ArmLink& link) {
  Result<robot::RobotState> state = link.latest();
  const std::string why = link.status().last_error;
  if (state || why.empty() || link.status().connected) return state;
  return fail(state.error().code, "robot %.60s: %.150s", link.address().c_str(), why.c_str());
}

std::string model_of(const arm_link::Robot& robot) {
  return robot.make + " " + robot.model;
}

robot::ur::ControllerWords words_of(const arm_link::Robot& robot, const robot::RobotState& state) {
  robot::ur::ControllerWords words;
  words.model = model_of(robot);
  if (!robot.serial.empty()) words.serial = robot.serial;
  words.robot_mode = state.powered ? "RUNNING" : "POWER_OFF";
  words.program_state = state.program_running ? "PLAYING" : "STOPPED";
  return words;
}

void say_what_is_looked_at(const arm_link::Robot& robot, const kinematics::ArmModel& arm) {
  say_when_new("robot", model_of(robot) + ", serial number " +
                            (robot.serial.empty() ? "not told" : robot.serial) +
                            ", by the generic protocol: pendant, remote control, software and its own "
                            "kinematics are not looked at; its pose is held against a " +
                            arm.name + "'s");
}

Result<robot::ur::ControllerWords> ask(const robot::other::ArmLink& link, const kinematics::ArmModel& arm,
                                       robot::ArmFacts& facts) {
  BITELINE_ASSIGN(const robot::RobotState state, newest(link));
  BITELINE_TRY(ask_other_arm(link, arm, state, facts));
  const std::optional<arm_link::Robot> robot = link.robot();
  if (!robot) return fail(Errc::ConnectionLost, "robot %.60s", link.address().c_str());
  say_what_is_looked_at(*robot, arm);
  return words_of(*robot, state);
}

}  // namespace

ArmSeen see_other_arm(const robot::other::ArmLink& link, const kinematics::ArmModel& arm) {
  ArmSeen seen{.arm = arm};
  const Result<robot::RobotState> state = link.latest();
  if (state) seen.q_rad = state->q_rad;
  if (state) seen.T_flange_tcp = state->T_flange_tcp;
  return seen;
}

Result<void> ask_other_arm(const robot::other::ArmLink& link, const kinematics::ArmModel& arm,
                           const robot::RobotState& state, robot::ArmFacts& facts) {
  const std::optional<arm_link::Robot> robot = link.robot();
  if (!robot) return fail(Errc::ConnectionLost, "robot %.60s", link.address().c_str());
  facts.told_model = model_of(*robot);
  if (!robot->serial.empty()) facts.told_serial = robot->serial;
  const SE3 T_base_tcp = kinematics::forward(arm, state.q_rad) * state.T_flange_tcp;
  facts.pose_off_mm = (T_base_tcp.translation() - state.T_base_tcp.translation()).norm();
  facts.pose_off_rad = geometry::angle_between_rad(T_base_tcp.linear(), state.T_base_tcp.linear());
  return {};
}

ControllerLook look_at_other_arm(const robot::other::ArmLink& link, const kinematics::ArmModel& arm,
                                 const std::string& serial) {
  robot::ArmFacts facts;
  facts.arm = arm.name;
  if (!serial.empty()) facts.serial = serial;
  ControllerLook look{.words = ask(link, arm, facts), .wrong = {}};
  if (!look.words) {
    look.wrong = to_line(look.words.error());
    return look;
  }
  look.wrong = robot::why_not_ready(facts);
  if (look.wrong.empty() && look.words->robot_mode == "POWER_OFF")
    look.wrong = "the arm has no power: switch it on";
  if (!look.wrong.empty()) return look;
  if (const auto stands = robot::wait_until_still(link, {.patience_s = 1}); !stands) {
    look.moves = stands.error().code == Errc::Timeout;
    look.wrong = to_line(stands.error());
  }
  return look;
}

}  // namespace biteline::service
