// SPDX-License-Identifier: MIT
/// \file The service before an arm of another make: the whole job, a stop on the way, and whom it refuses.
#include <CppUTest/TestHarness.h>

#include <cstdio>

#include "hal/sim/live/urgency.hpp"
#include "hal/sim/robot/path_taker.hpp"
#include "host/robot/kinematics/arm_model.hpp"
#include "tests/integration/robot/person.hpp"
#include "tests/support/json.hpp"
#include "tests/support/timed_test.hpp"

namespace biteline {
namespace {

sim::JointVector home_rad() {
  return (sim::JointVector() << 0.0, -1.8, 1.6, -1.4, -1.57, 0.0).finished();
}

struct ServiceWithOtherArm : ServiceWithArm {
  sim::Arm arm{*sim::ArmKinematics::named("ur5e"), home_rad()};
  std::unique_ptr<sim::PathTaker> taker;

  void setup() override {
    // Its threads begin with the rights of the one that makes them.
    const sim::Urgently urgently{sim::k_robot_priority};
    taker = *sim::PathTaker::open({}, arm);
  }
  [[nodiscard]] sim::ArmState now() const { return arm.at(hal::monotonic_now()); }
  [[nodiscard]] bool tool_on() const { return now().outputs != 0; }

  /// As coarse_process() has it, and twice as fast.
  [[nodiscard]] std::string fast_text() const {
    std::ifstream coarse{coarse_process()};
    std::string text{std::istreambuf_iterator<char>{coarse}, {}};
    const std::string slow = "  speed_mm_s: 60\n";
    const std::size_t at = text.find(slow);
    CHECK(at != std::string::npos);
    return text.replace(at, slow.size(), "  speed_mm_s: 120\n");
  }
  [[nodiscard]] std::vector<std::string> for_model(const std::string& model, const fs::path& out) const {
    const fs::path process = folder.write("fast.yaml", fast_text());
    return {"--sensor",   k_no_sensor,
            "--out",      out.string(),
            "--robot",    model,
            "--process",  process.string(),
            "--table-z",  recorded().table_z,
            "--arm-link", "127.0.0.1:" + std::to_string(taker->port()),
            "--send"};
  }
  /// With doors, and a person who vouches for the recorded shoe.  Its model is not known, so it waits.
  [[nodiscard]] ChildProcess hold() const {
    fs::create_directories(results() / "processes");
    std::ofstream{results() / "processes/fast.yaml"} << fast_text();
    return start(for_model("UR5e", results()),
                 {"--control", "tcp://127.0.0.1:0", "--models", "--library",
                  (folder.path() / "models").string(), "--confirm", "scan-0001", "--keep-recording"});
  }
  /// Until a person may say yes to its path.
  static void wait_for_yes(const Page& page) {
    const auto held = [](const control::Json& row) { return row["decision"] == "held"; };
    static_cast<void>(page.scan_once("scan-0001", held));
    page.wait_until_deciding();
    LONGS_EQUAL(202, page.ask("POST", "/scans/scan-0001/process", {{"process", "fast"}}).status);
    page.scan_once("scan-0001",
                   [&](const control::Json& row) { return row["reason_code"].is_null() && held(row); });
    page.wait_until_deciding();
    const control::Json waits = page.ask("GET", "/state").body["held"];
    CHECK_TEXT(waits["sendable"].get<bool>(), test::text_of(waits).c_str());
  }
  template <class Done>
  static void wait_until(Done&& done) {
    const auto until = std::chrono::steady_clock::now() + k_patience;
    while (!done() && std::chrono::steady_clock::now() < until) std::this_thread::sleep_for(2ms);
    CHECK(done());
  }
  static nlohmann::json followed_of(const fs::path& scan) {
    std::ifstream stream{scan / "followed.json"};
    return test::read_json(stream);
  }
};

}  // namespace

TEST_GROUP_BASE(ServiceAndOtherArm, ServiceWithOtherArm){};

ORDINARY_TIMED_TEST(ServiceAndOtherArm, TheWholeJobFromTheScanToTheWorkedPath) {
  const fs::path scan = leave_scan("scan-0001");
  ChildProcess host = hold();
  Page page{address_told(host)};
  page.begin();
  wait_for_yes(page);
  CHECK_EQUAL(0U, taker->paths_run());
  CHECK_FALSE(tool_on());

  LONGS_EQUAL(200, page.ask("POST", "/scans/scan-0001/accept").status);
  wait_until([&] { return tool_on() || fs::exists(scan / "followed.json"); });
  CHECK_TEXT(tool_on(), reasons_of(scan).c_str());
  wait_until([&] { return fs::exists(scan / "followed.json"); });
  static_cast<void>(
      page.scan_once("scan-0001", [](const control::Json& row) { return row["decision"] == "accepted"; }));
  const nlohmann::json followed = followed_of(scan);
  CHECK_TEXT(followed.value("completed", false), followed.dump().c_str());
  CHECK(followed.value("covered", 0.0) > 0.999);
  STRCMP_EQUAL("off", followed.value("tool_output", "").c_str());
  LONGS_EQUAL(0, followed.value("stops_sent", -1));
  CHECK(followed.value("dead_man", false));
  std::printf("tip %.4f mm at most beside the path, %.1f s\n", followed["from_path_mm"].value("max", 0.0),
              followed.value("duration_s", 0.0));
  CHECK_FALSE(now().moving);
  CHECK_FALSE(tool_on());
  CHECK_EQUAL(1U, taker->paths_run());

  const nlohmann::json arm_facts = gate_of(scan)["inputs"]["arm"];
  STRCMP_EQUAL("made UR5e by another name", arm_facts.value("told_model", "").c_str());
  STRCMP_EQUAL("1", arm_facts.value("told_serial", "").c_str());
  CHECK(arm_facts.value("pose_off_mm", 1.0) < 0.01);
  CHECK(arm_facts.value("held", false));
  // Another service finds the arm held.
  ChildProcess second = start(for_model("UR5e", folder.path() / "other"), {});
  LONGS_EQUAL(static_cast<int>(ExitStatus::Connection), end_of(second).first);
  STRCMP_CONTAINS("biteline-host", second.last_words().c_str());
}

ORDINARY_TIMED_TEST(ServiceAndOtherArm, AStopInMidPathEndsItWithTheToolOff) {
  const fs::path scan = leave_scan("scan-0001");
  ChildProcess host = hold();
  Page page{address_told(host)};
  page.begin();
  wait_for_yes(page);
  LONGS_EQUAL(200, page.ask("POST", "/scans/scan-0001/accept").status);
  wait_until([&] { return tool_on() || fs::exists(scan / "followed.json"); });
  CHECK_TEXT(tool_on(), reasons_of(scan).c_str());
  LONGS_EQUAL(200, page.ask("POST", "/commands/stop").status);
  wait_until([&] { return fs::exists(scan / "followed.json"); });
  const nlohmann::json followed = followed_of(scan);
  STRCMP_EQUAL("stopped_by_a_person", followed["stopped"].value("reason_code", "").c_str());
  CHECK(followed.value("at_rest", false));
  STRCMP_EQUAL("off", followed.value("tool_output", "").c_str());
  CHECK(taker->fault() == arm_link::Fault::Host);
  CHECK_FALSE(now().moving);
  CHECK_FALSE(tool_on());
}

/// An arm that is built otherwise than the model that is told: no scan is spent, and the cause is said.
TEST(ServiceAndOtherArm, AnArmThatIsBuiltOtherwiseIsRefusedByItsPose) {
  leave_scan("scan-0001");
  ChildProcess host =
      start(for_model("UR10e", results()), {"--once", "--confirm", "scan-0001", "--keep-recording"});
  const auto [status, said] = end_of(host);
  LONGS_EQUAL(static_cast<int>(ExitStatus::Refused), status);
  CHECK_EQUAL(0U, taker->paths_run());
  STRCMP_CONTAINS("other_arm", reasons_of(results() / "scan-0001").c_str());
}

TEST(ServiceAndOtherArm, WhatIsAURsAloneIsNoOptionOfAnotherArm) {
  for (const char* option :
       {"--rtde", "--script", "--dashboard", "--robot-api", "--hold-register", "--clamp-input"}) {
    ChildProcess host = start(for_model("UR5e", results()), {option, "1"});
    LONGS_EQUAL_TEXT(static_cast<int>(ExitStatus::BadInput), end_of(host).first, option);
    STRCMP_CONTAINS(option, host.last_words().c_str());
  }
  ChildProcess host = start(for_model("UR5e", results()), {"--kinematics", "/no/such/file"});
  LONGS_EQUAL(static_cast<int>(ExitStatus::BadInput), end_of(host).first);
  STRCMP_CONTAINS("/no/such/file", host.last_words().c_str());
}

}  // namespace biteline
