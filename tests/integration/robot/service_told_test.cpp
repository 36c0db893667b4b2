// SPDX-License-Identifier: MIT
// A sensor without poses, a machine without time, a robot that is not ready: told as what they are, and less
// and less often.
#include <CppUTest/TestHarness.h>

#include <optional>
#include <vector>

#include "tests/integration/robot/person.hpp"
#include "tests/support/json.hpp"

namespace biteline {

/// A service before a sensor that has a fault.
struct ServiceTold : ServiceWithArm {
  using Clock = std::chrono::steady_clock;
  std::optional<ChildProcess> sensor, host;
  std::optional<Page> page;

  std::string start_sensor(const char* fault) {
    auto child =
        ChildProcess::start({.program = BITELINE_MADE_SENSOR, .arguments = {fault}, .pass_stderr = true});
    SUCCEEDS(child);
    sensor.emplace(std::move(*child));
    const auto address = sensor->next_line(k_patience);
    SUCCEEDS(address);
    return *address;
  }
  void start_host(std::vector<std::string> all, const std::vector<std::string>& more) {
    host.emplace(start(std::move(all), more));
    page.emplace(address_told(*host));
    page->begin();
  }
  /// When the sensor was asked for a scan, by its own word.
  std::chrono::milliseconds asked() {
    const auto line = sensor->next_line(k_patience);
    SUCCEEDS(line);
    STRCMP_CONTAINS("start ", line->c_str());
    return std::chrono::milliseconds{std::stoll(line->substr(line->rfind(' ')))};
  }
  control::Json state_with(const char* words) const {
    const auto until = Clock::now() + k_patience;
    control::Json state;
    do {
      std::this_thread::sleep_for(10ms);
      state = page->ask("GET", "/state").body;
    } while (state.value("now", "").find(words) == std::string::npos && Clock::now() < until);
    STRCMP_CONTAINS(words, state.value("now", "").c_str());
    return state;
  }
  /// What was said until now.
  std::string said() { return said_until(""); }
  /// What was said until a line with these words, which may still be on its way.
  std::string said_until(const char* words) {
    std::string lines;
    while (const auto line = host->next_line(*words == '\0' ? 0ms : k_patience)) {
      lines += *line + "\n";
      if (*words != '\0' && line->find(words) != std::string::npos) break;
    }
    return lines;
  }
  static int count(const std::string& lines, const char* words) {
    int times = 0;
    for (std::size_t at = lines.find(words); at != std::string::npos; at = lines.find(words, at + 1)) ++times;
    return times;
  }
  /// The sensor is asked again after so many seconds at least; less than that would be another law.
  void is_asked_after(const std::vector<int>& waits_s) {
    std::chrono::milliseconds before = asked();
    for (const int wait_s : waits_s) {
      const std::chrono::milliseconds now = asked();
      CHECK_TEXT(now - before >= std::chrono::seconds{wait_s}, std::to_string(wait_s).c_str());
      before = now;
    }
  }
  /// A start is a person's word to ask at once: sooner than the wait that has just begun.
  void is_asked_at_once_by_a_start(int wait_s) {
    const auto begin = std::chrono::duration_cast<std::chrono::milliseconds>(Clock::now().time_since_epoch());
    LONGS_EQUAL(202, page->ask("POST", "/commands/start").status);
    CHECK(asked() - begin < std::chrono::seconds{wait_s});
  }
};

TEST_GROUP_BASE(ServiceTold, ServiceTold){};

TEST(ServiceTold, ScansWithoutPosesAreToldAsThatAndAskedForLessAndLess) {
  start_host(arguments(start_sensor("no-poses")), {"--control", "tcp://127.0.0.1:0", "--models", "--library",
                                                   (folder.path() / "models").string()});
  is_asked_after({2, 4, 8});
  static_cast<void>(
      page->scan_once("scan-0004", [](const control::Json& row) { return row["verdict"] == "refused"; }));
  const control::Json state = state_with("0 of 40 profiles can be used: no pose (40)");
  STRCMP_EQUAL("fault", state.value("phase", "").c_str());
  STRCMP_CONTAINS("check the arm's cable", state.value("next", "").c_str());
  STRCMP_CONTAINS("the next scan after 16 s, or by a start", state.value("next", "").c_str());
  CHECK(state["held"].is_null());
  is_asked_at_once_by_a_start(16);

  const control::Json row = page->ask("GET", "/scans/scan-0001").body;
  STRCMP_EQUAL("no_poses", row["reason_code"].get<std::string>().c_str());
  STRCMP_EQUAL("machine", row["ended_by"].get<std::string>().c_str());
  CHECK_TEXT(row["reason"].get<std::string>().find("shoe") == std::string::npos, test::text_of(row).c_str());
  // Each scan is told once, and nothing else of it.
  const std::string lines = said_until("/scan-0005");
  LONGS_EQUAL_TEXT(5, count(lines, "takes in scan"), lines.c_str());
  LONGS_EQUAL_TEXT(5, count(lines, "asks for a scan"), lines.c_str());
  CHECK_TEXT(count(lines, "no pose") <= count(lines, "takes in scan"), lines.c_str());
  CHECK_TEXT(lines.find("shoe") == std::string::npos, lines.c_str());
  const control::Json trends = page->ask("GET", "/history/trends").body;
  CHECK(trends["ended_by"]["machine"].get<int>() >= 4);
  LONGS_EQUAL(0, trends["ended_by"]["shoe"].get<int>());
}

TEST(ServiceTold, AMachineWithoutTimeIsToldAsThat) {
  start_host(arguments(start_sensor("busy")), {"--control", "tcp://127.0.0.1:0"});
  const control::Json row =
      page->scan_once("scan-0001", [](const control::Json& one) { return one["verdict"] == "refused"; });
  STRCMP_EQUAL("no_time", row["reason_code"].get<std::string>().c_str());
  STRCMP_CONTAINS("of 440 pictures 400 were lost", row["reason"].get<std::string>().c_str());
  STRCMP_CONTAINS("end what else runs", state_with("sensor or host had no time").value("next", "").c_str());
}

TEST(ServiceTold, ASensorThatDoesNotBeginIsAskedLessAndLessAndKeepsItsLink) {
  start_host(arguments(start_sensor("refuses")), {"--control", "tcp://127.0.0.1:0"});
  is_asked_after({2, 4});
  const control::Json state = state_with("the sensor does not begin a scan: no camera answers");
  STRCMP_EQUAL("fault", state.value("phase", "").c_str());
  STRCMP_CONTAINS("or by a start", state.value("next", "").c_str());
  CHECK(page->ask("GET", "/sensors").body["sensors"][0]["connected"].get<bool>());
  is_asked_at_once_by_a_start(8);
  LONGS_EQUAL(1, count(said(), "connected to "));
}

/// The sensor ends it as if it were whole; what there is of it is no shoe all the same, and a person's doing.
TEST(ServiceTold, AScanThatAPersonStopsOnItsWayIsHisAndSaysNothingOfAShoe) {
  start_host(arguments(start_sensor("slow")), {"--control", "tcp://127.0.0.1:0"});
  static_cast<void>(asked());
  static_cast<void>(state_with("scan-0001 comes in"));
  LONGS_EQUAL(200, page->ask("POST", "/commands/stop").status);
  const control::Json row =
      page->scan_once("scan-0001", [](const control::Json& one) { return one["verdict"] == "refused"; });
  STRCMP_EQUAL("stopped_by_a_person", row["reason_code"].get<std::string>().c_str());
  STRCMP_EQUAL("person", row["ended_by"].get<std::string>().c_str());
  STRCMP_CONTAINS("the scan was stopped by ", row["reason"].get<std::string>().c_str());
  CHECK_TEXT(test::text_of(row).find("shoe") == std::string::npos, test::text_of(row).c_str());
  const control::Json trends = page->ask("GET", "/history/trends").body;
  LONGS_EQUAL(1, trends["ended_by"]["person"].get<int>());
  CHECK(trends["buckets"].empty());
  CHECK(trends["reasons"].empty());
  const control::Json state = state_with("stopped by ");
  STRCMP_EQUAL("stopped", state.value("phase", "").c_str());
  LONGS_EQUAL(1, count(said(), "asks for a scan"));
}

TEST(ServiceTold, ARobotThatIsNotReadyIsToldWithItsReasonAndNoScanIsSpent) {
  controller.local_control = true;
  start_host(sending(start_sensor("no-poses")), {"--control", "tcp://127.0.0.1:0"});
  const control::Json state = state_with("the robot is not ready: ");
  STRCMP_EQUAL("fault", state.value("phase", "").c_str());
  STRCMP_CONTAINS("remote control is off", state.value("now", "").c_str());
  // Three looks, each two seconds after the one before, and two words at most.
  std::this_thread::sleep_for(5s);
  const std::string lines = said();
  const int told = count(lines, "no scan is spent");
  CHECK_TEXT(told >= 1 && told <= 2, lines.c_str());
  LONGS_EQUAL(0, count(lines, "asks for a scan"));
  controller.local_control = false;
  static_cast<void>(asked());
}

}  // namespace biteline
