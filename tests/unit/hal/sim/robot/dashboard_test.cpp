// SPDX-License-Identifier: MIT
// Words and answers as they stand in Universal Robots' "Dashboard server e-Series" and "... CB-series".
#include "hal/sim/robot/dashboard.hpp"

#include <CppUTest/TestHarness.h>

namespace biteline::sim::dashboard {

TEST_GROUP(Dashboard) {
  Facts facts{.version = {5, 12, 0}, .model = "UR10e", .serial = "20235500001"};
  std::map<std::string, std::string> programs{{"wait.urp", "sleep(10)\n"}};
  Memory memory;

  Answer ask(std::string_view line) {
    return answer_to(line, facts, programs, memory);
  }
  void says(const char* answer, std::string_view line) {
    STRCMP_EQUAL(answer, ask(line).text.c_str());
  }
};

TEST(Dashboard, EachGenerationKnowsItsOwnWords) {
  for (const char* line : {"is in remote control", "safetystatus", "get operational mode", "version"}) {
    facts.version = {5, 12, 0};
    CHECK_TEXT(!ask(line).text.starts_with("could not understand"), line);
    facts.version = {3, 15, 8};
    CHECK_TEXT(ask(line).text.starts_with("could not understand"), line);
  }
  says("NONE", "getUserRole");
  says("Setting user role: OPERATOR", "setUserRole OPERATOR");
  says("OPERATOR", "getUserRole");
  says("Failed setting user role: KING", "setUserRole KING");
  facts.version = {5, 12, 0};
  CHECK(ask("getUserRole").text.starts_with("could not understand"));
}

TEST(Dashboard, AProgramIsLoadedPlayedPausedAndStopped) {
  says("No program loaded", "get loaded program");
  says("Failed to execute: play", "play");
  says("File not found: none.urp", "load none.urp");
  CHECK(ask("load /programs/wait.urp").order == Order::Load);
  says("Loaded program: /programs/wait.urp", "get loaded program");
  says("STOPPED wait.urp", "programState");
  says("true wait.urp", "isProgramSaved");
  CHECK(ask("play").order == Order::Play);
  says("Failed to execute: pause", "pause");
  facts.program = ProgramState::Playing;
  facts.program_name = "wait";
  says("PLAYING wait", "programState");
  CHECK(ask("pause").order == Order::Pause);
  facts.program = ProgramState::Paused;
  says("PAUSED wait", "programState");
  CHECK(ask("play").order == Order::Play);
  CHECK(ask("stop").order == Order::Stop);
}

TEST(Dashboard, NothingIsPlayedWhereTheArmMayNotMove) {
  ask("load wait.urp");
  for (auto* spoil :
       {+[](Facts& f) { f.mode = RobotMode::Idle; }, +[](Facts& f) { f.takes_programs = false; },
        +[](Facts& f) { f.protective_stop = true; }}) {
    Facts spoilt = facts;
    spoil(spoilt);
    STRCMP_EQUAL("Failed to execute: play", answer_to("play", spoilt, programs, memory).text.c_str());
  }
}

TEST(Dashboard, AFreshProtectiveStopIsLookedAtFirst) {
  facts.protective_stop = facts.just_stopped = true;
  CHECK(ask("unlock protective stop").order == Order::None);
  CHECK(ask("unlock protective stop").text.starts_with("Cannot unlock protective stop until 5s"));
  facts.just_stopped = false;
  CHECK(ask("unlock protective stop").order == Order::Unlock);
}

TEST(Dashboard, PowerAndModesAreTold) {
  const struct {
    RobotMode mode;
    const char* answer;
  } rows[] = {{RobotMode::PowerOff, "Robotmode: POWER_OFF"},
              {RobotMode::Booting, "Robotmode: BOOTING"},
              {RobotMode::Idle, "Robotmode: IDLE"},
              {RobotMode::Running, "Robotmode: RUNNING"}};
  for (const auto& row : rows) {
    facts.mode = row.mode;
    says(row.answer, "robotmode");
  }
  CHECK(ask("power on").order == Order::PowerOn);
  CHECK(ask("power off").order == Order::PowerOff);
  CHECK(ask("restart safety").order == Order::PowerOff);
  CHECK(ask("brake release").order == Order::ReleaseBrakes);
  says("Operational mode MANUAL is set", "set operational mode manual");
  says("MANUAL", "get operational mode");
  says("Failed setting operational mode: FAST", "set operational mode fast");
  ask("clear operational mode");
  says("NONE", "get operational mode");
}

TEST(Dashboard, AWordIsTakenWholeOrNotAtAll) {
  for (const char* line : {"", "robot", "robotmodes", "robotmode now", "popup", "load", "PLAY"})
    CHECK_TEXT(ask(line).text.starts_with("could not understand"), line);
  CHECK(ask("popup hello").order == Order::None);
  STRCMP_EQUAL("hello", memory.popup.c_str());
  CHECK(ask("close popup").order == Order::ClosePopup);
  STRCMP_EQUAL("", memory.popup.c_str());
}

}  // namespace biteline::sim::dashboard
