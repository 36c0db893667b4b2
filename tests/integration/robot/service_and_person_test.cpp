// SPDX-License-Identifier: MIT
// The service before a person: a held scan, a word, a model's name, a result worked out again, a stop.
#include <CppUTest/TestHarness.h>

#include <csignal>
#include <set>
#include <thread>

#include "host/cloud/closed_line.hpp"
#include "tests/integration/robot/person.hpp"
#include "tests/support/json.hpp"

namespace biteline {

TEST_GROUP_BASE(ServiceAndPerson, ServiceWithArm){};

TEST(ServiceAndPerson, HeldScanThatTheGateWouldRefuseIsNotAcceptedAndWaitsOn) {
  leave_scan("scan-0001");
  ChildProcess host = start(holding(), {"--keep-recording"});
  Page page{address_told(host)};
  LONGS_EQUAL(401, page.ask("GET", "/state").status);
  page.begin();
  const control::Json held =
      page.scan_once("scan-0001", [](const control::Json& scan) { return scan["decision"] == "held"; });
  STRCMP_EQUAL("held", held["decision"].get<std::string>().c_str());
  CHECK(!held["sent"].get<bool>());
  page.wait_until_deciding();
  LONGS_EQUAL(409, page.ask("POST", "/commands/start").status);

  // A person's yes is not all that must hold: nobody saw this scan come in, and the page is told before.
  const control::Json waits = page.ask("GET", "/state").body["held"];
  CHECK_FALSE(waits["sendable"].get<bool>());
  STRCMP_EQUAL("scan_not_seen", waits["reason_code"].get<std::string>().c_str());
  for (const char* word : {"accept", "send"}) {
    const control::Answer answer = page.ask("POST", std::string{"/scans/scan-0001/"} + word);
    LONGS_EQUAL_TEXT(409, answer.status, word);
    STRCMP_CONTAINS("scan seen coming in", test::text_of(answer.body).c_str());
  }
  const control::Json row = page.ask("GET", "/scans/scan-0001").body;
  STRCMP_EQUAL("held", row["decision"].get<std::string>().c_str());
  CHECK(row["decided_by"].is_null());
  STRCMP_EQUAL("deciding", page.ask("GET", "/state").body["phase"].get<std::string>().c_str());
  CHECK(!fs::exists(results() / "scan-0001/gate.json"));
  CHECK(controller.script().empty());
}

TEST(ServiceAndPerson, KeptScanIsWorkedOutAgainBesideItsResultAndNothingIsSent) {
  const fs::path scan = leave_scan("scan-0001");
  ChildProcess host = start(holding(), {});
  Page page{address_told(host)};
  page.begin();
  static_cast<void>(
      page.scan_once("scan-0001", [](const control::Json& row) { return row["decision"] == "held"; }));
  page.wait_until_deciding();
  const auto line_then = fs::last_write_time(scan / "line.csv");
  const auto again = [&](const control::Json& settings, std::size_t number) {
    LONGS_EQUAL(202, page.ask("POST", "/scans/scan-0001/rerun", {{"settings", settings}}).status);
    return page.scan_once("scan-0001", [&](const control::Json& row) {
      return row["reruns"].size() == number && row["reruns"].back()["state"] == "done";
    })["reruns"];
  };
  // The line as it stands along another process, and the line looked for anew.
  control::Json reruns = again({{"process", "cement"}}, 1);
  STRCMP_EQUAL("cement", reruns[0]["process"].get<std::string>().c_str());
  STRCMP_EQUAL("rerun-1/line.csv", reruns[0]["line"].get<std::string>().c_str());
  CHECK(fs::exists(scan / "rerun-1/path/report.json"));
  CHECK(fs::exists(scan / "rerun-1/view_data.js"));
  reruns = again({{"method", "default"}}, 2);
  const auto found = cloud::read_line(scan / "line.csv"), anew = cloud::read_line(scan / "rerun-2/line.csv");
  SUCCEEDS(found);
  SUCCEEDS(anew);
  DOUBLES_EQUAL(cloud::length_mm(*found), cloud::length_mm(*anew), 0.01);
  CHECK(fs::exists(scan / "rerun-2/path/path.csv"));
  // What went wrong is told where the outcome would stand.
  fs::rename(scan / "cloud.ply", scan / "moved");
  LONGS_EQUAL(409,
              page.ask("POST", "/scans/scan-0001/rerun", {{"settings", {{"method", "default"}}}}).status);
  std::ofstream{scan / "cloud.ply"} << "no cloud";
  reruns = again({{"method", "default"}}, 3);
  STRCMP_EQUAL("rerun_failed", reruns[2]["reason_code"].get<std::string>().c_str());

  CHECK(line_then == fs::last_write_time(scan / "line.csv"));
  CHECK(!fs::exists(scan / "gate.json"));
  CHECK(controller.script().empty());
  const control::Json row = page.ask("GET", "/scans/scan-0001").body;
  STRCMP_EQUAL("held", row["decision"].get<std::string>().c_str());
  CHECK(!row["sent"].get<bool>());
}

TEST(ServiceAndPerson, ProcessIsPlannedAndCheckedOnAKeptLineAndNothingIsWritten) {
  const fs::path scan = leave_scan("scan-0001");
  ChildProcess host = start(holding(), {});
  Page page{address_told(host)};
  page.begin();
  static_cast<void>(
      page.scan_once("scan-0001", [](const control::Json& row) { return row["decision"] == "held"; }));
  page.wait_until_deciding();
  const auto files_of = [&] {
    std::set<std::string> files;
    for (const auto& entry : fs::recursive_directory_iterator{scan}) files.insert(entry.path().string());
    return files;
  };
  const std::set<std::string> before = files_of();
  control::Json process = page.ask("GET", "/processes/grind").body["process"];
  const auto tried = [&] { return page.ask("POST", "/processes/check", {{"process", process}}); };
  const control::Json fits = tried().body;
  CHECK_TEXT(fits.value("fits", false), test::text_of(fits).c_str());
  STRCMP_EQUAL("scan-0001", fits["scan"].get<std::string>().c_str());
  CHECK(fits["duration_s"].get<double>() > 1);
  // Slower takes longer: what is planned is what was typed.
  process["motion"]["speed_mm_s"] = 0.5 * process["motion"]["speed_mm_s"].get<double>();
  CHECK(tried().body["duration_s"].get<double>() > 1.2 * fits["duration_s"].get<double>());
  // A tool as long as the arm reaches nothing.
  process["tool"]["tcp_position_mm"] = {0, 0, 900};
  const control::Json refused = tried().body;
  CHECK_TEXT(refused.contains("fits") && !refused["fits"].get<bool>(), test::text_of(refused).c_str());
  CHECK(!refused["reason"].get<std::string>().empty());
  process["tool"]["tcp_position_mm"] = {0, 0};
  LONGS_EQUAL(422, tried().status);
  CHECK(before == files_of());
  CHECK(controller.script().empty());
}

TEST(ServiceAndPerson, ScanOfNoKnownModelWaitsUntilAPersonNamesIt) {
  const fs::path scan = leave_scan("scan-0001");
  ChildProcess host = start(holding(), {"--models", "--library", (folder.path() / "models").string()});
  Page page{address_told(host)};
  page.begin();
  const auto held = [](const control::Json& row) { return row["decision"] == "held"; };
  control::Json row = page.scan_once("scan-0001", held);
  STRCMP_EQUAL("model_unknown", row["reason_code"].get<std::string>().c_str());
  STRCMP_CONTAINS("the model is not known", row["reason"].get<std::string>().c_str());
  CHECK(fs::exists(scan / "line.csv"));
  CHECK(!fs::exists(scan / "path"));
  LONGS_EQUAL(409, page.ask("POST", "/scans/scan-0001/accept").status);
  LONGS_EQUAL(
      409,
      page.ask("POST", "/scans/scan-0001/mend",
               {{"line_version", 0}, {"why", "x"}, {"steps", {{{"step", "candidate"}, {"candidate", 1}}}}})
          .status);
  LONGS_EQUAL(404, page.ask("POST", "/scans/scan-0001/model", {{"model", "boot"}}).status);

  // It becomes a model itself, and goes on as one.
  LONGS_EQUAL(201, page.ask("POST", "/models", {{"name", "boot"}, {"scan", "scan-0001"}}).status);
  LONGS_EQUAL(202, page.ask("POST", "/scans/scan-0001/model", {{"model", "boot"}}).status);
  LONGS_EQUAL(409, page.ask("POST", "/scans/scan-0001/model", {{"model", "boot"}}).status);
  row = page.scan_once("scan-0001",
                       [&](const control::Json& now) { return now["model"] == "boot" && held(now); });
  CHECK(row["reason_code"].is_null());
  CHECK(fs::exists(scan / "path/path.csv"));
  CHECK(controller.script().empty());
}

TEST(ServiceAndPerson, ScanOfNoKnownModelIsRefusedWhereNobodyCanBeAsked) {
  const fs::path scan = leave_scan("scan-0001");
  ChildProcess host =
      start(sending(k_no_sensor), {"--once", "--models", "--library", (folder.path() / "models").string()});
  LONGS_EQUAL(static_cast<int>(ExitStatus::Refused), end_of(host).first);
  STRCMP_EQUAL("model_unknown", report_of(scan).value("reason_code", "").c_str());
  CHECK(!fs::exists(scan / "line.csv"));
  CHECK(controller.script().empty());
}

TEST(ServiceAndPerson, RejectedScanKeepsItsReasonAndAnotherServiceRemembersIt) {
  leave_scan("scan-0001");
  {
    ChildProcess host = start(holding(), {});
    Page page{address_told(host)};
    page.begin();
    static_cast<void>(
        page.scan_once("scan-0001", [](const control::Json& scan) { return scan["decision"] == "held"; }));
    LONGS_EQUAL(200, page.ask("POST", "/scans/scan-0001/reject", {{"why", "a hole at the toe"}}).status);
    LONGS_EQUAL(409, page.ask("POST", "/scans/scan-0001/accept").status);
    ::kill(host.pid(), SIGKILL);
    SUCCEEDS(host.wait(k_patience));
  }
  CHECK(controller.script().empty());
  CHECK(!fs::exists(results() / "scan-0001/gate.json"));
  ChildProcess next = start(holding(), {});
  Page page{address_told(next)};
  page.token = page.ask("POST", "/sessions", {{"name", "ada"}, {"password", "a long password"}})
                   .body["token"]
                   .get<std::string>();
  const control::Json scan = page.ask("GET", "/scans/scan-0001").body;
  STRCMP_EQUAL("rejected", scan["decision"].get<std::string>().c_str());
  STRCMP_EQUAL("a hole at the toe", scan["why"].get<std::string>().c_str());
  CHECK(fs::exists(results() / "scan-0001/stages/6_sequence.png"));
}

TEST(ServiceAndPerson, LocalControlAtThePendantEndsWhatWaitsAndOnlyAStartBeginsAnew) {
  leave_scan("scan-0001");
  ChildProcess host = start(holding(), {});
  Page page{address_told(host)};
  page.begin();
  static_cast<void>(
      page.scan_once("scan-0001", [](const control::Json& scan) { return scan["decision"] == "held"; }));
  page.wait_until_deciding();
  // The watch has seen it in remote control.
  std::this_thread::sleep_for(1500ms);
  STRCMP_EQUAL("deciding", page.ask("GET", "/state").body["phase"].get<std::string>().c_str());
  controller.local_control = true;
  const control::Json row = page.scan_once(
      "scan-0001", [](const control::Json& scan) { return scan["reason_code"] == "stopped_by_a_person"; });
  STRCMP_EQUAL("stopped_by_a_person", row["reason_code"].get<std::string>().c_str());
  // Giving it back takes nothing back.
  controller.local_control = false;
  std::this_thread::sleep_for(1500ms);
  const control::Json state = page.ask("GET", "/state").body;
  STRCMP_EQUAL("stopped", state["phase"].get<std::string>().c_str());
  STRCMP_CONTAINS("somebody at the pendant", state["now"].get<std::string>().c_str());
  CHECK(state["held"].is_null());
  const control::Answer accept = page.ask("POST", "/scans/scan-0001/accept");
  LONGS_EQUAL(409, accept.status);
  STRCMP_CONTAINS("was stopped", test::text_of(accept.body).c_str());
  LONGS_EQUAL(202, page.ask("POST", "/commands/start").status);
  const auto until = std::chrono::steady_clock::now() + k_patience;
  while (page.ask("GET", "/state").body["phase"] == "stopped" && std::chrono::steady_clock::now() < until)
    std::this_thread::sleep_for(50ms);
  CHECK(page.ask("GET", "/state").body["phase"] != "stopped");
  CHECK(controller.script().empty());
}

TEST(ServiceAndPerson, StopAtTheCellNeedsNoLoginAndEndsThePlansOfTheService) {
  ChildProcess host = start(holding(), {});
  Page page{address_told(host)};
  LONGS_EQUAL(200, page.ask("POST", "/commands/stop").status);
  page.begin();
  const auto until = std::chrono::steady_clock::now() + k_patience;
  while (page.ask("GET", "/state").body["phase"] != "stopped" && std::chrono::steady_clock::now() < until)
    std::this_thread::sleep_for(50ms);
  STRCMP_EQUAL("stopped", page.ask("GET", "/state").body["phase"].get<std::string>().c_str());
  LONGS_EQUAL(202, page.ask("POST", "/commands/start").status);
  // Without a sensor it is not running either, and says so once it has called it.
  std::string phase = "stopped";
  while ((phase == "stopped" || phase == "starting") && std::chrono::steady_clock::now() < until) {
    std::this_thread::sleep_for(50ms);
    phase = page.ask("GET", "/state").body["phase"].get<std::string>();
  }
  STRCMP_EQUAL("fault", phase.c_str());
}

}  // namespace biteline
