// SPDX-License-Identifier: MIT
#include "hal/sim/robot/program.hpp"

#include <CppUTest/TestHarness.h>

#include "hal/sim/robot/blends.hpp"
#include "tests/support/transforms.hpp"

namespace biteline::sim {

TEST_GROUP(Program) {
  ArmKinematics arm = *ArmKinematics::named("ur5e");
  JointVector home_rad{(JointVector() << 0.1, -1.4, 1.7, -1.8, -1.5, 0.2).finished()};

  Program planned(const char* text) {
    return Program::plan(*parse_script(text), arm, arm.T_base_flange(home_rad), SE3::Identity());
  }
};

TEST(Program, AJointMoveEndsAtItsJointsAndHalfWayIsHalfWayInJoints) {
  const Program sut = planned("movej([0.5,-1.2,1.5,-1.6,-1.4,0.4], a=1, v=0.5)\n");
  JointVector goal_rad;
  goal_rad << 0.5, -1.2, 1.5, -1.6, -1.4, 0.4;
  TRANSFORMS_EQUAL(arm.T_base_flange(home_rad), sut.T_base_flange_at(0), 1e-3, 1e-6);
  TRANSFORMS_EQUAL(arm.T_base_flange(goal_rad), sut.T_base_flange_at(sut.duration_s() + 1), 1e-6, 1e-9);
  TRANSFORMS_EQUAL(arm.T_base_flange((home_rad + goal_rad) / 2), sut.T_base_flange_at(sut.duration_s() / 2),
                   1e-3, 1e-6);
  // 0.4 rad at 0.5 rad/s with 1 rad/s^2: 0.4 / 0.5 + 0.5 / 1
  DOUBLES_EQUAL(1.3, sut.duration_s(), 1e-6);
}

TEST(Program, TheToolFrameMovesTheFlangeAway) {
  const Program sut = planned(
      "set_tcp(p[0,0,0.15,0,0,0])\n"
      "movel(p[-0.4,0.1,0.2,3.14159265358979,0,0], a=1, v=0.1)\n");
  // Tool upside down: the flange stands 150 mm above its tip.
  const SE3 T = sut.T_base_flange_at(1e3);
  DOUBLES_EQUAL(350, T.translation().z(), 1e-6);
  DOUBLES_EQUAL(150, sut.T_flange_tcp_at(1e3).translation().z(), 1e-9);
}

TEST(Program, OutputsChangeWhenTheMovesBeforeThemAreDone) {
  const Program sut = planned(
      "movel(p[-0.4,0.1,0.2,3.14159265358979,0,0], v=0.5)\n"
      "set_digital_out(2, True)\n"
      "sleep(1)\n"
      "set_digital_out(2, False)\n");
  LONGS_EQUAL(0, sut.outputs_at(0.01));
  LONGS_EQUAL(4, sut.outputs_at(sut.duration_s() - 0.5));
  LONGS_EQUAL(0, sut.outputs_at(sut.duration_s() + 0.1));
}

TEST(Program, MovesGoAtTheSlidersShareAndWaitsAsTheyAre) {
  const Program sut = planned(
      "movej([0.5,-1.2,1.5,-1.6,-1.4,0.4], a=1, v=0.5)\n"
      "sleep(2)\n"
      "movej([0.1,-1.4,1.7,-1.8,-1.5,0.2], a=1, v=0.5)\n");
  DOUBLES_EQUAL(2 * 1.3 + 2, sut.duration_s(), 1e-6);
  DOUBLES_EQUAL(0.65, sut.later_s(0, 1.3, 0.5), 1e-12);
  DOUBLES_EQUAL(1.3, sut.later_s(0, 2.6, 0.5), 1e-6);
  DOUBLES_EQUAL(3.3, sut.later_s(0, 4.6, 0.5), 1e-6);
  DOUBLES_EQUAL(4.6, sut.later_s(0, 7.2, 0.5), 1e-6);
  DOUBLES_EQUAL(5.6, sut.later_s(0, 8.2, 0.5), 1e-6);  // behind its end time goes on
  DOUBLES_EQUAL(0.4, sut.later_s(0.4, 100, 0), 0);
  DOUBLES_EQUAL(3.3, sut.later_s(2, 100, 0), 1e-6);  // what waits ends, what comes then does not begin
}

TEST(Program, NeverJumps) {
  const Program sut = planned(
      "set_tcp(p[0,0,0.1,0,0,0])\n"
      "movej([0.3,-1.3,1.6,-1.7,-1.5,0.3])\n"
      "movel(p[-0.45,0.1,0.2,3.14159265358979,0,0], v=0.3)\n"
      "movep(p[-0.45,0.2,0.2,3.1,0.1,0], v=0.1, r=0.005)\n"
      "movep(p[-0.40,0.25,0.2,3.0,0.2,0], v=0.1, r=0)\n"
      "movej(p[-0.40,0.25,0.3,3.0,0.2,0])\n");
  constexpr double k_step_s = 0.002;
  for (double t = 0; t < sut.duration_s(); t += k_step_s) {
    const SE3 step = sut.T_base_flange_at(t).inverse() * sut.T_base_flange_at(t + k_step_s);
    CHECK(step.translation().norm() <
          2000 * k_step_s);  // 1.05 rad/s at under a metre's reach, and the tool's turn
    CHECK(geometry::log_so3(step.linear()).norm() < 8 * k_step_s);
  }
}

TEST(Program, PayloadIsWhatTheScriptSaid) {
  const Program sut = planned("set_payload(1.8, [0,0,0.07])\nsleep(1)\nset_payload(0.5)\nsleep(1)\n");
  DOUBLES_EQUAL(1.8, sut.payload_at(0.5).mass_kg, 1e-12);
  DOUBLES_EQUAL(70, sut.payload_at(0.5).centre_mm.z(), 1e-9);
  DOUBLES_EQUAL(0.5, sut.payload_at(1.5).mass_kg, 1e-12);
}

/// As a real controller: the move is left out, and said.
TEST(Program, MovesWhoseBlendsMeetAreSkippedAndWarnedOf) {
  const struct {
    const char* text;
    std::size_t kept, warnings;
  } rows[] = {
      {"movep(p[0.400,0,0.3,0,0,0], r=0.001)\nmovep(p[0.402,0,0.3,0,0,0], r=0.001)\n", 2, 0},
      {"movep(p[0.400,0,0.3,0,0,0], r=0.001)\nmovep(p[0.4019,0,0.3,0,0,0], r=0.001)\n", 1, 1},
      {"movep(p[0.400,0,0.3,0,0,0], r=0.0008)\nmovep(p[0.4015,0,0.3,0,0,0], r=0.0008)\n"
       "movep(p[0.4030,0,0.3,0,0,0], r=0.0008)\n",
       2, 1},
      {"movel(p[0.400,0,0.3,0,0,0], r=0.01)\nmovel(p[0.405,0,0.3,0,0,0])\n", 1, 1},
      {"movep(p[0.400,0,0.3,0,0,0], r=0.001)\nset_digital_out(0, True)\n"
       "movep(p[0.4005,0,0.3,0,0,0], r=0.001)\n",
       2, 1},
      {"movep(p[0.400,0,0.3,0,0,0], r=0.001)\nsleep(1)\nmovep(p[0.4005,0,0.3,0,0,0], r=0.001)\n", 3, 0},
      {"movel(p[0.400,0,0.3,0,0,0])\nmovel(p[0.4001,0,0.3,0,0,0])\n", 2, 0},
  };
  for (const auto& row : rows) {
    Script script = *parse_script(row.text);
    const std::vector<std::string> warnings = skip_overlapping_blends(script);
    LONGS_EQUAL_TEXT(row.kept, script.steps.size(), row.text);
    LONGS_EQUAL_TEXT(row.warnings, warnings.size(), row.text);
    if (!warnings.empty()) STRCMP_CONTAINS("Overlapping Blends", warnings[0].c_str());
  }
}

}  // namespace biteline::sim
