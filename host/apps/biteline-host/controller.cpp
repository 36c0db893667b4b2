// SPDX-License-Identifier: MIT
#include "host/apps/biteline-host/controller.hpp"

#include <charconv>
#include <cmath>
#include <map>
#include <mutex>
#include <numbers>
#include <utility>

#include "common/core/fixed_text.hpp"
#include "host/apps/biteline-host/other_controller.hpp"
#include "host/apps/biteline-host/scan_pipeline.hpp"
#include "host/robot/kinematics/chain.hpp"
#include "host/robot/kinematics/dh_rows.hpp"
#include "host/robot/link/follow.hpp"
#include "host/robot/link/ur/told_kinematics.hpp"
#include "host/robot/path/mounted.hpp"

namespace biteline::service {
namespace {

/// How far the controller's own tip is from that of the arm with its joints.
double tip_off_mm(const kinematics::ArmModel& arm, const robot::RobotState& state) {
  const SE3 T_base_tcp = kinematics::forward(arm, state.q_rad) * state.T_flange_tcp;
  return (T_base_tcp.translation() - state.T_base_tcp.translation()).norm();
}

/// A service that was killed leaves its program running; a scan's own way ends after the scan does.
Result<void> arm_stands(const ControllerAddress& controller) {
  BITELINE_ASSIGN(const std::shared_ptr<robot::RobotLink> link, open_robot(controller));
  BITELINE_TRY(robot::wait_until_still(*link, {.patience_s = 1}));
  return {};
}

}  // namespace

/// Of what is looked at again and again: a line that says nothing new of its subject fills logs.
void say_when_new(const std::string& subject, const std::string& words) {
  static std::mutex mutex;
  static std::map<std::string, std::string> said;
  const std::lock_guard lock{mutex};
  if (std::exchange(said[subject], words) == words) return;
  log_step("%s: %s", subject.c_str(), words.c_str());
}

Result<HostPort> parse_host_port(const std::string& text) {
  const std::size_t colon = text.rfind(':');
  HostPort parsed{.host = text.substr(0, colon), .port = 0};
  const char* end = text.data() + text.size();
  if (colon == std::string::npos || colon == 0 ||
      std::from_chars(text.data() + colon + 1, end, parsed.port).ptr != end || parsed.port == 0) {
    return fail(Errc::InvalidArgument, "controller '%s': HOST:PORT expected", text.c_str());
  }
  return parsed;
}

Result<robot::ur::DoorPlaces> doors_of(const ControllerAddress& controller) {
  BITELINE_ASSIGN(const HostPort script, parse_host_port(controller.script));
  robot::ur::DoorPlaces places{.script = {.host = script.host, .port = script.port}};
  if (controller.dashboard.empty() && controller.robot_api.empty()) {
    places.dashboard = {.host = script.host, .port = robot::ur::k_dashboard_port};
    places.robot_api = {.host = script.host, .port = robot::ur::k_robot_api_port};
  }
  const auto take = [&](const char* option, const std::string& text,
                        robot::ur::Endpoint& into) -> Result<void> {
    if (text.empty()) return {};
    BITELINE_ASSIGN(const HostPort at, parse_host_port(text));
    if (at.host != script.host) {
      return fail(Errc::InvalidArgument, "%s %s and --script %s are two machines", option, text.c_str(),
                  controller.script.c_str());
    }
    into = {.host = at.host, .port = at.port};
    return {};
  };
  BITELINE_TRY(take("--dashboard", controller.dashboard, places.dashboard));
  BITELINE_TRY(take("--robot-api", controller.robot_api, places.robot_api));
  return places;
}

Result<std::shared_ptr<robot::RobotLink>> open_robot(const ControllerAddress& controller,
                                                     double connect_patience_s, robot::ur::ArmClaim* claim,
                                                     bool ask_force, int flange_input) {
  if (controller.other) return controller.other;
  BITELINE_ASSIGN(const HostPort rtde, parse_host_port(controller.rtde));
  BITELINE_ASSIGN(const HostPort script, parse_host_port(controller.script));
  if (rtde.host != script.host) {
    return fail(Errc::InvalidArgument, "--rtde %s and --script %s are two machines", controller.rtde.c_str(),
                controller.script.c_str());
  }
  BITELINE_ASSIGN(const robot::ur::DoorPlaces doors, doors_of(controller));
  robot::ur::UrLink::Config config;
  config.host = rtde.host;
  config.rtde_port = rtde.port;
  config.script_port = script.port;
  config.dashboard_port = doors.dashboard.port;
  config.robot_api_port = doors.robot_api.port;
  config.connect_patience_s = connect_patience_s;
  config.claim = claim;
  config.ask_force = ask_force;
  config.flange_input = flange_input;
  return robot::ur::UrLink::open(config);
}

ArmSeen see_arm(const ControllerAddress& controller, const kinematics::ArmModel& nominal) {
  if (controller.other) return see_other_arm(*controller.other, nominal);
  constexpr double k_patience_s = 0.5;
  ArmSeen seen{.arm = nominal};
  const auto say = [&](const std::string& words) { say_when_new("kinematics", words); };
  const auto own = [&]() -> Result<kinematics::ArmModel> {
    BITELINE_ASSIGN(const HostPort script, parse_host_port(controller.script));
    BITELINE_ASSIGN(const robot::ur::ToldKinematics told,
                    robot::ur::ask_kinematics({.host = script.host, .port = script.port},
                                              Nanoseconds{std::llround(1e9 * k_patience_s)}));
    return kinematics::with_rows(nominal, told.rows, "the controller's kinematics");
  }();
  const auto link = open_robot(controller, k_patience_s);
  const Result<robot::RobotState> state =
      link ? (*link)->latest() : Result<robot::RobotState>{tl::unexpected<Error>{link.error()}};
  if (state) seen.q_rad = state->q_rad;
  if (state) seen.T_flange_tcp = state->T_flange_tcp;
  if (!own) {
    say("the nominal " + nominal.name + "'s, some 2 mm beside the arm: " + to_line(own.error()));
    return seen;
  }
  if (!state) {
    say("the nominal " + nominal.name +
        "'s: the controller's tip cannot be compared: " + to_line(state.error()));
    return seen;
  }
  if (const double off_mm = tip_off_mm(*own, *state); !(off_mm <= robot::k_pose_off_mm)) {
    say(std::string{
        FixedText<160>::format("the nominal %.20s's: the controller's tip is %.2f mm from that of its "
                               "own rows (limit %.1f)",
                               nominal.name.c_str(), off_mm, robot::k_pose_off_mm)
            .view()});
    return seen;
  }
  seen.arm = *own;
  say(std::string{
      FixedText<120>::format("the arm's own, from its controller; the nominal tip would be %.1f mm "
                             "beside it here",
                             tip_off_mm(nominal, *state))
          .view()});
  return seen;
}

std::string tool_difference(const path::Process& process, const SE3& T_flange_tcp) {
  constexpr double k_turn_rad = 0.0175;
  const SE3& own = process.tool.T_flange_tcp;
  const double off_mm = (own.translation() - T_flange_tcp.translation()).norm();
  const double off_rad = geometry::log_so3(own.linear().transpose() * T_flange_tcp.linear()).norm();
  if (off_mm <= path::k_taught_tip_mm && off_rad <= k_turn_rad) return {};
  const Vec3 told = T_flange_tcp.translation(), asked = own.translation();
  return std::string{FixedText<400>::format(
                         "the controller's tip stands at (%.1f, %.1f, %.1f) mm in the flange, that of %.60s "
                         "at (%.1f, %.1f, %.1f): %.1f mm and %.1f degrees apart; the path's program sets "
                         "the process's; where the pendant's was measured, mend tcp_position_mm and "
                         "tcp_rotation_deg of the process",
                         told.x(), told.y(), told.z(), process.name.c_str(), asked.x(), asked.y(), asked.z(),
                         off_mm, off_rad * 180 / std::numbers::pi)
                         .view()};
}

void say_tool_difference(const path::Process& process, const SE3& T_flange_tcp) {
  const std::string words = tool_difference(process, T_flange_tcp);
  say_when_new("tool", words.empty() ? "the controller's tip is that of " + process.name : words);
}

Result<void> ask_about_itself(const ControllerAddress& controller, const kinematics::ArmModel& arm,
                              const robot::RobotState& state, robot::ArmFacts& facts) {
  if (controller.other) return ask_other_arm(*controller.other, arm, state, facts);
  BITELINE_ASSIGN(const robot::ur::DoorPlaces doors, doors_of(controller));
  BITELINE_ASSIGN(const robot::ur::ControllerWords words, robot::ur::ask_controller(doors, k_door_patience));
  facts.told_version = words.version;
  facts.told_model = words.model;
  facts.told_serial = words.serial;
  facts.told_remote = words.remote;
  return {};
}

ControllerLook look_at_controller(const ControllerAddress& controller, const kinematics::ArmModel& arm,
                                  const std::string& serial) {
  if (controller.other) return look_at_other_arm(*controller.other, arm, serial);
  const Result<robot::ur::DoorPlaces> doors = doors_of(controller);
  ControllerLook look{.words = doors
                                   ? robot::ur::ask_controller(*doors, k_door_patience)
                                   : Result<robot::ur::ControllerWords>{tl::unexpected<Error>{doors.error()}},
                      .wrong = {}};
  if (!look.words) {
    look.wrong = to_line(look.words.error());
    return look;
  }
  say_when_new("robot", robot::ur::summary(*look.words));
  robot::ArmFacts facts;
  facts.arm = arm.name;
  if (!serial.empty()) facts.serial = serial;
  facts.told_version = look.words->version;
  facts.told_model = look.words->model;
  facts.told_serial = look.words->serial;
  facts.told_remote = look.words->remote;
  look.wrong = robot::why_not_ready(facts);
  const std::string mode = look.words->robot_mode.value_or("");
  if (look.wrong.empty() && (mode == "POWER_OFF" || mode == "DISCONNECTED" || mode == "NO_CONTROLLER"))
    look.wrong = "the arm has no power (" + mode + "): switch it on at the teach pendant";
  if (!look.wrong.empty()) return look;
  if (const Result<void> stands = arm_stands(controller); !stands) {
    look.moves = stands.error().code == Errc::Timeout;
    look.wrong = to_line(stands.error());
  }
  return look;
}

}  // namespace biteline::service
