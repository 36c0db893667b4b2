// SPDX-License-Identifier: MIT
// `biteline doctor`: what is ready, what one can do with it, and what the arm's controller says; and how the
// tool takes words that were mistyped.
#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "host/intake/child_process.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/json.hpp"
#include "tests/unit/host/robot/link/fake_controller.hpp"

namespace biteline {

using namespace std::chrono_literals;
using nlohmann::json;

TEST_GROUP(Doctor) {
  struct Said {
    int status{0};
    std::string out, last_error;
  };
  static Said say(const std::vector<std::string>& arguments) {
    auto child = intake::ChildProcess::start({.program = BITELINE_TOOL, .arguments = arguments});
    SUCCEEDS(child);
    Said said;
    while (const auto line = child->next_line(30s)) said.out += *line + "\n";
    const auto status = child->wait(30s);
    SUCCEEDS(status);
    said.status = *status;
    said.last_error = child->last_words();
    return said;
  }
  static json doctor(std::vector<std::string> more = {}) {
    more.insert(more.begin(), {"doctor", "--json"});
    return test::read_json(say(more).out);
  }
  static json row_of(const json& rows, const std::string& what) {
    const auto row = std::ranges::find_if(rows, [&](const json& r) { return r.value("what", "") == what; });
    CHECK_TEXT(row != rows.end(), what.c_str());
    return row == rows.end() ? json{} : *row;
  }
};

TEST(Doctor, TellsWhatOneCanDoAndWhyNotTheRest) {
  const json told = doctor();
  CHECK(row_of(told["abilities"], "work out recordings and plan paths").value("can", false));
  std::set<std::string> missing;
  for (const json& finding : told["findings"]) {
    if (finding["ready"]) continue;
    CHECK(!finding["step"].get<std::string>().empty());
    missing.insert(finding["what"].get<std::string>() + ": " + finding["seen"].get<std::string>());
  }
  for (const json& ability : told["abilities"]) {
    CHECK(ability["can"].get<bool>() == ability["missing"].empty());
    for (const json& reason : ability["missing"]) CHECK(missing.contains(reason.get<std::string>()));
  }
  const std::string words = say({"doctor"}).out;
  STRCMP_CONTAINS("you can:    work out recordings", words.c_str());
}

TEST(Doctor, AsksTheRobotOnlyWhereItIsTold) {
  robot::test::FakeController controller;
  controller.answers = {{"PolyscopeVersion", "URSoftware 5.12.0.0 (Jan 01 2022)"},
                        {"get robot model", "UR10"},
                        {"get serial number", "20215500001"},
                        {"is in remote control", "true"},
                        {"robotmode", "Robotmode: RUNNING"}};
  const std::string address = "127.0.0.1:" + std::to_string(controller.dashboard_port());
  json told = doctor({"--robot", address});
  CHECK(row_of(told["abilities"], "send paths to this robot").value("can", false));
  STRCMP_CONTAINS("20215500001",
                  row_of(told["findings"], "robot at " + address)["seen"].get<std::string>().c_str());

  controller.answers["is in remote control"] = "false";
  told = doctor({"--robot", address});
  CHECK(!row_of(told["abilities"], "send paths to this robot").value("can", true));
  STRCMP_CONTAINS("Remote Control",
                  row_of(told["findings"], "robot at " + address)["step"].get<std::string>().c_str());
  // Nobody there.
  told = doctor({"--robot", "127.0.0.1:1"});
  CHECK(!row_of(told["abilities"], "send paths to this robot").value("can", true));
  for (const json& ability : doctor()["abilities"])
    CHECK(ability["what"].get<std::string>() != "send paths to this robot");
}

TEST(Doctor, MistypedWordsAreAnsweredByTheNearestOne) {
  STRCMP_CONTAINS("did you mean --out?", say({"extract", "cloud.ply", "--ot", "x"}).last_error.c_str());
  STRCMP_CONTAINS("did you mean --board?", say({"doctor", "--bord=x"}).last_error.c_str());
  STRCMP_CONTAINS("did you mean replay?", say({"replya"}).last_error.c_str());
  // What is near to nothing keeps the parser's own words.
  STRCMP_CONTAINS("--out is required", say({"extract", "cloud.ply", "--frobnicate"}).last_error.c_str());
  STRCMP_CONTAINS("biteline ", say({"-V"}).out.c_str());
  STRCMP_EQUAL(say({"replay", "--help"}).out.c_str(), say({"help", "replay"}).out.c_str());
  LONGS_EQUAL(0, say({"help"}).status);
}

}  // namespace biteline
