// SPDX-License-Identifier: MIT
// What the service asks of the arm before a scan is spent.
#include <CppUTest/TestHarness.h>

#include "host/apps/biteline-host/controller.hpp"
#include "tests/support/timed_test.hpp"
#include "tests/unit/host/robot/link/fake_controller.hpp"

namespace biteline::service {

TEST_GROUP(ControllerLook) {
  robot::test::FakeController controller;

  void setup() override {
    controller.answers = {{"PolyscopeVersion", "URSoftware 5.12.0.0 (Jan 01 2022)"},
                          {"get robot model", "UR5"},
                          {"get serial number", "20215500001"},
                          {"is in remote control", "true"}};
  }
  ControllerAddress address() const {
    const auto at = [](std::uint16_t port) { return "127.0.0.1:" + std::to_string(port); };
    return {.rtde = at(controller.rtde_port()),
            .script = at(controller.script_port()),
            .dashboard = at(controller.dashboard_port())};
  }
  ControllerLook look() const {
    return look_at_controller(address(), *kinematics::arm_model("UR5e"), "");
  }
};

ORDINARY_TIMED_TEST(ControllerLook, ArmThatStandsIsReady) {
  const ControllerLook sut = look();
  STRCMP_EQUAL("", sut.wrong.c_str());
  CHECK(!sut.moves);
}

/// The path of a service that was killed goes on: no light beside an arm that moves.
ORDINARY_TIMED_TEST(ControllerLook, ArmThatMovesIsNotReadyAndWillBe) {
  controller.turning = true;
  const ControllerLook moving = look();
  STRCMP_CONTAINS("still moves", moving.wrong.c_str());
  CHECK(moving.moves);
  controller.turning = false;
  STRCMP_EQUAL("", look().wrong.c_str());
}

ORDINARY_TIMED_TEST(ControllerLook, SilentControllerIsWrongAndNotJustMoving) {
  controller.silent = true;
  const ControllerLook sut = look();
  CHECK(!sut.wrong.empty());
  CHECK(!sut.moves);
}

ORDINARY_TIMED_TEST(ControllerLook, AToolThatIsNotTheProcesssIsToldByName) {
  const ArmSeen seen = see_arm(address(), *kinematics::arm_model("UR5e"));
  CHECK(seen.T_flange_tcp.has_value());
  path::Process process = *path::read_process(std::filesystem::path{BITELINE_PROCESSES} / "grind.yaml");
  const std::string words = tool_difference(process, *seen.T_flange_tcp);
  for (const char* part : {"(0.0, 0.0, 150.0) mm", "that of grind at (0.0, 0.0, 180.0)",
                           "30.0 mm and 0.0 degrees", "tcp_position_mm"})
    STRCMP_CONTAINS(part, words.c_str());
  process.tool.T_flange_tcp.translation() = Vec3{0.3, 0, 150.5};
  STRCMP_EQUAL("", tool_difference(process, *seen.T_flange_tcp).c_str());
  // The same place, and the tool points elsewhere.
  process.tool.T_flange_tcp.linear() = Eigen::AngleAxisd{0.2, Vec3::UnitX()}.toRotationMatrix();
  STRCMP_CONTAINS("11.5 degrees", tool_difference(process, *seen.T_flange_tcp).c_str());
}

/// A dashboard that is told and does not answer is no reason to call at the usual ports.
TEST(ControllerLook, OfTwoDoorsTheToldOneIsCalled) {
  ControllerAddress there{.rtde = "arm:1", .script = "arm:30001", .dashboard = {}};
  const auto ports = [&] {
    const auto doors = doors_of(there);
    return doors ? std::to_string(doors->dashboard.port) + " " + std::to_string(doors->robot_api.port)
                 : "none";
  };
  STRCMP_EQUAL("29999 80", ports().c_str());
  there.dashboard = "arm:7";
  STRCMP_EQUAL("7 0", ports().c_str());
  there.robot_api = "arm:8";
  STRCMP_EQUAL("7 8", ports().c_str());
  there.dashboard.clear();
  STRCMP_EQUAL("0 8", ports().c_str());
  there.robot_api = "other:8";
  STRCMP_EQUAL("none", ports().c_str());
  STRCMP_CONTAINS("--robot-api other:8", to_line(doors_of(there).error()).c_str());
}

ORDINARY_TIMED_TEST(ControllerLook, LocalControlIsSaidFirst) {
  controller.answers["is in remote control"] = "false";
  controller.turning = true;
  const ControllerLook sut = look();
  STRCMP_CONTAINS("remote control is off", sut.wrong.c_str());
  CHECK(!sut.moves);
}

}  // namespace biteline::service
