// SPDX-License-Identifier: MIT
// Programs with control flow, by the controller's time alone.
#include "hal/sim/robot/script_runner.hpp"

#include <CppUTest/TestHarness.h>

#include "tests/support/transforms.hpp"

namespace biteline::sim {
namespace {

constexpr double k_cycle_s = 0.002;

SensorClock::time_point instant_of(double time_s) {
  return SensorClock::time_point{Nanoseconds{1'000'000'000 + static_cast<std::int64_t>(time_s * 1e9 + 0.5)}};
}

struct NoInputs final : RtdeInputs {
  int input_register(int number) const override { return number == 5 ? value : 0; }
  std::optional<SensorClock::time_point> written(const std::string&) const override { return std::nullopt; }
  int value{0};
};

}  // namespace

TEST_GROUP(ScriptRunner) {
  ArmKinematics kinematics = *ArmKinematics::named("ur5e");
  JointVector q_rad = (JointVector() << 0.1, -1.4, 1.7, -1.8, -1.5, 0.2).finished();
  Arm arm{kinematics, q_rad};
  ScriptRunner sut{arm, k_cycle_s};
  NoInputs inputs;
  double now_s{0};
  std::vector<ProgramNews> news;

  void run(const char* text) {
    auto program = parse_program(text);
    CHECK_TEXT(program.has_value(), program ? "" : to_line(program.error()).c_str());
    sut.run(std::move(*program), q_rad, instant_of(now_s));
  }
  void go_until(double until_s) {
    for (; now_s < until_s; now_s += k_cycle_s) {
      STRCMP_EQUAL("", sut.step(instant_of(now_s), inputs, q_rad).c_str());
      for (ProgramNews& one : sut.take_news()) news.push_back(std::move(one));
    }
  }
  std::string told(ProgramNews::Kind kind) const {
    std::string all;
    for (const ProgramNews& one : news) all += one.kind == kind ? one.text + ";" : "";
    return all;
  }
  Vec3 tip() const {
    return arm.at(instant_of(now_s)).T_base_flange.translation();
  }
};

using Said = ProgramNews::Kind;

TEST(ScriptRunner, ALoopRunsUntilItIsStopped) {
  run("def test_fun():\n  while True:\n    textmsg(\"still running\")\n    sleep(1.0)\n    sync()\n  "
      "end\nend\n");
  go_until(3.5);
  STRCMP_EQUAL("test_fun;", told(Said::Started).c_str());
  STRCMP_EQUAL("still running;still running;still running;still running;", told(Said::Text).c_str());
  STRCMP_EQUAL("test_fun", sut.code_name()->c_str());
  sut.stop(instant_of(now_s));
  go_until(3.6);
  STRCMP_EQUAL("test_fun;", told(Said::Ended).c_str());
  CHECK(sut.code_name() == nullptr);
  CHECK_FALSE(arm.at(instant_of(now_s)).program_running);
}

TEST(ScriptRunner, PosesAreWorkedOutWhereTheArmIsThen) {
  const Vec3 begin = tip();
  run("def up():\n  i = 0\n  while i < 3:\n    here = get_actual_tcp_pose()\n"
      "    movel(pose_trans(p[0,0,0.01,0,0,0], here), a=1, v=0.1)\n    i = i + 1\n  end\nend\n");
  go_until(3);
  STRCMP_EQUAL("up;", told(Said::Ended).c_str());
  DOUBLES_EQUAL(30, (tip() - begin).norm(), 1e-6);
  DOUBLES_EQUAL(30, (tip() - begin).z(), 1e-6);
}

TEST(ScriptRunner, ABranchIsTakenByAnInput) {
  const char* const text =
      "def pick():\n  n = read_input_integer_register(5)\n  if n == 1:\n    textmsg(\"one\")\n  elif n == "
      "2:\n"
      "    textmsg(\"two\")\n  else:\n    textmsg(\"many\")\n  end\n  textmsg(\"end\")\nend\n";
  for (inputs.value = 1; inputs.value <= 3; ++inputs.value) {
    run(text);
    go_until(now_s + 0.1);
  }
  STRCMP_EQUAL("one;end;two;end;many;end;", told(Said::Text).c_str());
  STRCMP_EQUAL("pick;pick;pick;", told(Said::Ended).c_str());
}

TEST(ScriptRunner, ALoopWithoutTimeIsAFault) {
  run("def spin():\n  i = 0\n  while True:\n    i = i + 1\n  end\nend\n");
  go_until(0.1);
  STRCMP_CONTAINS("a loop without sync() or sleep()", told(Said::Fault).c_str());
  STRCMP_EQUAL("spin;", told(Said::Ended).c_str());
}

TEST(ScriptRunner, AValueThatIsNoneIsAFaultOfItsLine) {
  run("def odd():\n  while True:\n    sleep(nowhere)\n  end\nend\n");
  go_until(0.1);
  STRCMP_CONTAINS("script line 3: no value for 'nowhere'", told(Said::Fault).c_str());
  CHECK(sut.code_name() == nullptr);
}

TEST(ScriptRunner, AnotherProgramTakesItsPlaceForGood) {
  run("def first():\n  while True:\n    sleep(1)\n  end\nend\n");
  go_until(0.5);
  run("def second():\n  sleep(0.5)\nend\n");
  go_until(5);
  STRCMP_EQUAL("first;second;", told(Said::Started).c_str());
  STRCMP_EQUAL("first;second;", told(Said::Ended).c_str());
  CHECK_FALSE(arm.at(instant_of(now_s)).program_running);
}

TEST(ScriptRunner, APauseHoldsMovesAndSleepsAlike) {
  run("def go():\n  movej([0.5,-1.4,1.7,-1.8,-1.5,0.2], a=1, v=0.2)\n  sleep(1)\nend\n");
  go_until(1);
  sut.set_paused(true, instant_of(now_s));
  const SE3 there = arm.at(instant_of(now_s)).T_base_flange;
  go_until(6);
  TRANSFORMS_EQUAL(there, arm.at(instant_of(now_s)).T_base_flange, 1e-9, 1e-12);
  CHECK(arm.at(instant_of(now_s)).paused);
  sut.set_paused(false, instant_of(now_s));
  // 0.4 rad at 0.2 rad/s with its ramps: 2.2 s; then the sleep.
  go_until(6 + 2.2 - 1 + 1 - 0.02);
  CHECK(arm.at(instant_of(now_s)).program_running);
  go_until(6 + 2.2 - 1 + 1 + 0.02);
  CHECK_FALSE(arm.at(instant_of(now_s)).program_running);
}

TEST(ScriptRunner, ACodePausedBeforeItsFirstRowWaitsThere) {
  run("def go():\n  while True:\n    textmsg(\"on\")\n    sleep(1)\n  end\nend\n");
  sut.set_paused(true, instant_of(now_s));
  go_until(2);
  STRCMP_EQUAL("", told(Said::Text).c_str());
  CHECK(sut.is_paused());
  sut.set_paused(false, instant_of(now_s));
  go_until(2.5);
  STRCMP_EQUAL("on;", told(Said::Text).c_str());
}

TEST(ScriptRunner, ASecondaryProgramSwitchesAndTheOtherGoesOn) {
  run("def long():\n  sleep(10)\nend\n");
  go_until(0.1);
  run("sec side():\n  set_tool_digital_out(1, True)\n  set_configurable_digital_out(2, True)\n  "
      "textmsg(\"side\")\nend\n");
  go_until(0.2);
  STRCMP_EQUAL("side;", told(Said::Text).c_str());
  LONGS_EQUAL((1U << 17U) | (1U << 10U), arm.at(instant_of(now_s)).outputs);
  CHECK(arm.at(instant_of(now_s)).program_running);
  run("sec moves():\n  sleep(1)\nend\n");
  go_until(0.3);
  STRCMP_CONTAINS("a secondary program takes time or moves", told(Said::Fault).c_str());
  CHECK(arm.at(instant_of(now_s)).program_running);
}

TEST(ScriptRunner, AGoalBeyondAllLinksEndsTheProgramWithoutAMove) {
  const Vec3 begin = tip();
  run("def far():\n  movej(p[10,0,0,0,0,0])\n  textmsg(\"never\")\nend\n");
  go_until(0.1);
  STRCMP_CONTAINS("no joints reach the goal", told(Said::Fault).c_str());
  run("def far():\n  movel(p[10,0,0,0,0,0])\n  textmsg(\"never\")\nend\n");
  go_until(0.2);
  CHECK(std::ranges::count(news, Said::OutOfReach, &ProgramNews::kind) == 1);
  STRCMP_EQUAL("", told(Said::Text).c_str());
  DOUBLES_EQUAL(0, (tip() - begin).norm(), 1e-9);
}

TEST(ScriptRunner, WhatItAsksForEndsItOrIsShown) {
  run("def ask():\n  popup(\"look\")\n  protective_stop()\n  textmsg(\"never\")\nend\n");
  go_until(0.1);
  STRCMP_EQUAL("look;", told(Said::Popup).c_str());
  CHECK(std::ranges::count(news, Said::ProtectiveStop, &ProgramNews::kind) == 1);
  STRCMP_EQUAL("", told(Said::Text).c_str());
}

}  // namespace biteline::sim
