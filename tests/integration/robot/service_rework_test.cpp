// SPDX-License-Identifier: MIT
// A rework that a person has a word in: a yes of its own, a no, a stop on its way.
#include "tests/integration/robot/work_cell.hpp"

namespace biteline {

/// A person's yes was to the first path alone.  Rework is held for one of its own.
struct ApprovedCell : WorkedCell {
  std::optional<ChildProcess> host;
  std::optional<Page> page;

  /// To where the rework waits for a person.
  void work_to_rework() {
    begin_cell({std::to_string(k_gap_mm), "1"});
    host.emplace(start({"--control", "tcp://127.0.0.1:0"}, "  approval: person\n"));
    page.emplace(address_told(*host));
    page->begin();
    page->wait_until_deciding();
    LONGS_EQUAL(200, accept(*page, "scan-0001"));
    page->scan_once("scan-0002", [](const control::Json& one) { return one["decision"] == "held"; });
    page->wait_until_deciding();
  }
};

TEST_GROUP_BASE(ServiceApprovedRework, ApprovedCell){};

ORDINARY_TIMED_TEST(ServiceApprovedRework, IsWorkedAfterAYesOfItsOwn) {
  work_to_rework();
  CHECK(!fs::exists(results() / "scan-0002/gate.json"));
  CHECK(!row().work.reworked);
  LONGS_EQUAL(200, accept(*page, "scan-0002"));
  const control::Json again = page->scan_once("scan-0002", [](const control::Json& one) {
    return one["work"].is_object() && one["work"].value("verdict", "") != "looking";
  });
  STRCMP_EQUAL("ok", again["work"].value("verdict", "").c_str());
  CHECK(again.value("followed", false));
  CHECK(row().work.reworked);
  for (const double here : layers()) CHECK_COMPARE(here, >, 0.9);
}

ORDINARY_TIMED_TEST(ServiceApprovedRework, IsNotWorkedAfterANo) {
  work_to_rework();
  LONGS_EQUAL(200, page->ask("POST", "/scans/scan-0002/reject", {{"why", "by hand"}}).status);
  page->scan_once("scan-0002", [](const control::Json& one) { return one["decision"] == "rejected"; });
  CHECK(!row("scan-0002").sent && !row().work.reworked);
  STRCMP_EQUAL("work_faulty", row().reason_code.c_str());
  // A start is a person's word to go on.
  LONGS_EQUAL(202, page->ask("POST", "/commands/start", control::Json::object()).status);
  page->scan_once("scan-0003", [](const control::Json& one) { return one.contains("verdict"); });
}

/// The arm stands, and nothing of the shoe is worked again.
ORDINARY_TIMED_TEST(ServiceApprovedRework, AStopOnItsWayLeavesTheShoeToAPerson) {
  work_to_rework();
  LONGS_EQUAL(200, accept(*page, "scan-0002"));
  const auto until = std::chrono::steady_clock::now() + k_patience;
  while (page->ask("GET", "/state").body["phase"] != "following" && std::chrono::steady_clock::now() < until)
    std::this_thread::sleep_for(20ms);
  LONGS_EQUAL(200, page->ask("POST", "/commands/stop").status);
  const control::Json again = page->scan_once("scan-0002", [](const control::Json& one) {
    return one["reason"].is_string() && one["reason"].get<std::string>().find("stop") != std::string::npos;
  });
  CHECK(again["followed"] != true);
  CHECK(again["work"].is_null() || again["work"].value("verdict", "") != "ok");
  STRCMP_EQUAL("stopped", page->ask("GET", "/state").body.value("phase", "").c_str());
  CHECK(!fs::exists(results() / "scan-0002/work/look-1"));
  CHECK(!fs::exists(results() / "scan-0003"));
}

TEST_GROUP_BASE(ServiceApprovedReworkLong, ApprovedCell){};

/// Its pieces are places along its look's line.
ORDINARY_TIMED_TEST(ServiceApprovedReworkLong, TakesNoOtherProcess) {
  work_to_rework();
  fs::create_directories(results() / "processes");
  save_second({});
  LONGS_EQUAL(202, page->ask("POST", "/scans/scan-0002/process", {{"process", "second"}}).status);
  // It waits as before, with its own path.
  page->wait_until_deciding();
  LONGS_EQUAL(200, accept(*page, "scan-0002"));
  page->scan_once("scan-0002", [](const control::Json& one) {
    return one["work"].is_object() && one["work"].value("verdict", "") == "ok";
  });
  STRCMP_EQUAL("cement", row("scan-0002").process.c_str());
}

}  // namespace biteline
