// SPDX-License-Identifier: MIT
// Whose shoe it is: the part number goes with its scan, and a shoe that comes a second time is told.
#include <CppUTest/TestHarness.h>

#include <csignal>

#include "host/records/memory/memory.hpp"
#include "tests/integration/robot/person.hpp"
#include "tests/support/json.hpp"

namespace biteline {
namespace {

bool held(const control::Json& row) {
  return row["decision"] == "held";
}

}  // namespace

TEST_GROUP_BASE(ServicePart, ServiceWithArm){/// A shoe of this part number that was worked before.
                                             void remember_worked(const char* part)
                                                 const {fs::create_directories(results());
auto memory = memory::Memory::open(results() / memory::k_memory_file);
SUCCEEDS(memory);
memory::Scan scan;
scan.name = "scan-0001";
scan.time = memory::now_ms();
scan.verdict = "ok";
scan.part = part;
scan.sent = true;
scan.followed = true;
SUCCEEDS(memory->put_scan(scan, {}));
}  // namespace biteline
/// As the service marks a scan that begins.
fs::path leave_scan_of(const std::string& name, const char* part) const {
  const fs::path scan = leave_scan(name);
  std::ofstream{scan / "scan.part"} << part << "\n";
  return scan;
}
std::vector<std::string> with_doors() const {
  std::vector<std::string> all = sending(k_no_sensor);
  all.insert(all.end(), {"--control", "tcp://127.0.0.1:0"});
  return all;
}
}
;

TEST(ServicePart, AShoeThatWasWorkedBeforeWaitsForAPersonAndAnotherDoesNot) {
  remember_worked("A-17");
  const fs::path again = leave_scan_of("scan-0002", "A-17"), other = leave_scan_of("scan-0003", "A-18");
  ChildProcess host = start(with_doors(), {});
  Page page{address_told(host)};
  page.begin();
  const control::Json row = page.scan_once("scan-0002", held);
  STRCMP_EQUAL("part_worked_before", row["reason_code"].get<std::string>().c_str());
  STRCMP_CONTAINS("part A-17 was worked already: scan-0001", row["reason"].get<std::string>().c_str());
  STRCMP_EQUAL("A-17", row["part"].get<std::string>().c_str());
  STRCMP_EQUAL("A-17", row["report"]["part"].get<std::string>().c_str());
  page.wait_until_deciding();
  STRCMP_EQUAL("A-17", page.ask("GET", "/state").body["part"].get<std::string>().c_str());
  CHECK(!fs::exists(again / "gate.json"));
  LONGS_EQUAL(200, page.ask("POST", "/scans/scan-0002/reject", {{"why", "the same shoe"}}).status);
  // Of this process nobody need say yes: the gate itself has the word.
  const control::Json next =
      page.scan_once("scan-0003", [](const control::Json& scan) { return !scan["reason_code"].is_null(); });
  STRCMP_EQUAL("scan_not_seen", next["reason_code"].get<std::string>().c_str());
  STRCMP_EQUAL("A-18", next["part"].get<std::string>().c_str());
  STRCMP_EQUAL("A-18", report_of(other).value("part", "").c_str());
  CHECK(controller.script().empty());
}

TEST(ServicePart, WithoutADoorAShoeThatWasWorkedBeforeIsNotSent) {
  remember_worked("A-17");
  const fs::path again = leave_scan_of("scan-0002", "A-17");
  ChildProcess host = start(sending(k_no_sensor), {"--once"});
  const auto [status, said] = end_of(host);
  LONGS_EQUAL(static_cast<int>(ExitStatus::Refused), status);
  STRCMP_CONTAINS("scan-0002 is not sent: part A-17 was worked already: scan-0001", said.c_str());
  CHECK(!fs::exists(again / "gate.json"));
  CHECK(controller.script().empty());
  auto memory = memory::Memory::open_to_read(results() / memory::k_memory_file);
  SUCCEEDS(memory);
  const auto row = memory->scan("scan-0002");
  SUCCEEDS(row);
  STRCMP_EQUAL("part_worked_before", (*row)->reason_code.c_str());
}

TEST(ServicePart, WhatWasSaidOfTheNextShoeOutlivesTheServiceAndAStopEndsItsPartNumber) {
  const auto shown = [](const Page& page, const char* part) {
    const auto until = std::chrono::steady_clock::now() + k_patience;
    control::Json state;
    do {
      std::this_thread::sleep_for(50ms);
      state = page.ask("GET", "/state").body;
    } while (state.value("part", control::Json{}) != (*part == 0 ? control::Json{} : control::Json(part)) &&
             std::chrono::steady_clock::now() < until);
    CHECK_TEXT(state["part"] == (*part == 0 ? control::Json{} : control::Json(part)),
               test::text_of(state).c_str());
    return state;
  };
  const auto again = [&](ChildProcess& host) {
    ::kill(host.pid(), SIGKILL);
    SUCCEEDS(host.wait(k_patience));
    return start(with_doors(), {});
  };
  ChildProcess host = start(with_doors(), {});
  {
    Page page{address_told(host)};
    page.begin();
    const control::Json whose{{"foot", "left"}, {"size", "EU 42"}, {"part", "A-17"}};
    LONGS_EQUAL(202, page.ask("POST", "/commands/start", whose).status);
    shown(page, "A-17");
  }
  host = again(host);
  {
    Page page{address_told(host)};
    page.token = page.ask("POST", "/sessions", {{"name", "ada"}, {"password", "a long password"}})
                     .body["token"]
                     .get<std::string>();
    const control::Json state = shown(page, "A-17");
    STRCMP_EQUAL("left", state["foot"].get<std::string>().c_str());
    STRCMP_EQUAL("EU 42", state["size"].get<std::string>().c_str());
    LONGS_EQUAL(200, page.ask("POST", "/commands/stop").status);
    shown(page, "");
  }
  host = again(host);
  Page page{address_told(host)};
  page.token = page.ask("POST", "/sessions", {{"name", "ada"}, {"password", "a long password"}})
                   .body["token"]
                   .get<std::string>();
  // The job goes on, the shoe's own number does not.
  const auto until = std::chrono::steady_clock::now() + k_patience;
  control::Json state;
  do {
    std::this_thread::sleep_for(50ms);
    state = page.ask("GET", "/state").body;
  } while (state["foot"].is_null() && std::chrono::steady_clock::now() < until);
  STRCMP_EQUAL("left", state["foot"].get<std::string>().c_str());
  CHECK(state["part"].is_null());
}

}  // namespace biteline
