// SPDX-License-Identifier: MIT
// The service before an arm: what it must never send, and what must never end it.
#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <csignal>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "host/cloud/closed_line.hpp"
#include "host/control/client.hpp"
#include "host/intake/sensor_process.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/host/robot/link/fake_controller.hpp"

namespace biteline {
namespace {

namespace fs = std::filesystem;
using intake::ChildProcess;
using robot::test::FakeController;
using namespace std::chrono_literals;

constexpr auto k_patience = 240s;  // of a loaded machine

int run(const fs::path& program, const std::vector<std::string>& arguments) {
  auto child = ChildProcess::start({.program = program, .arguments = arguments, .pass_stderr = true});
  SUCCEEDS(child);
  const auto status = child->wait(k_patience);
  SUCCEEDS(status);
  return *status;
}

fs::path host_program() {
  return intake::find_sensor_program()->parent_path() / "biteline-host";
}

/// A scan with a shoe and a line, as a service that died left it; made once.
struct RecordedScan {
  test::TemporaryFolder folder;
  fs::path session{folder.path() / "session"};
  fs::path journal{folder.path() / "results/scan-0001/scan.btln"};
  std::string table_z;

  RecordedScan() {
    LONGS_EQUAL(0,
                run(BITELINE_CELL, {"record", "--shoe", "step", "--seed", "8", "--out", session.string()}));
    auto sensor = sensor_of_it();
    LONGS_EQUAL(0, run(host_program(), {"--sensor", sensor.endpoint().text(), "--out",
                                        (folder.path() / "results").string(), "--once", "--keep-recording"}));
    std::ifstream truth{session / "truth/T_base_shoe.txt"};
    for (int i = 0; i < 12; ++i) truth >> table_z;
  }

  [[nodiscard]] intake::SensorProcess sensor_of_it() const {
    auto sensor = intake::SensorProcess::start(
        *intake::find_sensor_program(), {"--source", "replay:" + session.string(), "--stay"}, k_patience);
    SUCCEEDS(sensor);
    return std::move(*sensor);
  }
};

const RecordedScan& recorded() {
  static const RecordedScan scan;
  return scan;
}

}  // namespace

TEST_GROUP(ServiceAndRobot) {
  test::TemporaryFolder folder;
  FakeController controller;

  void setup() override {
    controller.answers = {{"PolyscopeVersion", "URSoftware 5.12.0.0 (Jan 01 2022)"},
                          {"get robot model", "UR5"},
                          {"get serial number", "20215500001"},
                          {"is in remote control", "true"}};
  }
  static nlohmann::json gate_of(const fs::path& scan) {
    std::ifstream stream{scan / "gate.json"};
    return nlohmann::json::parse(stream, nullptr, false);
  }
  /// The reasons of the gate's rows that failed.
  static std::string reasons_of(const fs::path& scan) {
    std::string reasons;
    const nlohmann::json gate = gate_of(scan);
    for (const auto& row : gate.value("rows", nlohmann::json::array()))
      reasons += row.value("reason_code", "") + " ";
    return reasons;
  }
  fs::path results() const {
    return folder.path() / "results";
  }
  /// As a service leaves it that dies between the scan's end and its report.
  fs::path leave_scan(const std::string& name) const {
    const fs::path scan = results() / name;
    fs::create_directories(scan);
    fs::copy_file(recorded().journal, scan / "scan.btln");
    return scan;
  }
  std::vector<std::string> arguments(const std::string& sensor) const {
    return {"--sensor", sensor, "--out", results().string()};
  }
  static constexpr const char* k_no_sensor = "tcp://127.0.0.1:1";

  /// Grinding that takes what a short, coarse scan is good to: the gate's row of U95 has tests of its own.
  fs::path coarse_process() const {
    std::ifstream stream{fs::path{BITELINE_PROCESSES} / "grind.yaml"};
    std::string text{std::istreambuf_iterator<char>{stream}, {}};
    const std::string asked = "tolerance_mm: 1 ";
    const std::size_t at = text.find(asked);
    CHECK(at != std::string::npos);
    return folder.write("grind.yaml", text.replace(at, asked.size(), "tolerance_mm: 20 "));
  }
  std::vector<std::string> sending(const std::string& sensor) const {
    std::vector<std::string> all = arguments(sensor);
    const auto at = [](std::uint16_t port) { return "127.0.0.1:" + std::to_string(port); };
    const fs::path process = coarse_process();
    all.insert(all.end(), {"--robot", "UR5e", "--process", process.string(), "--table-z", recorded().table_z,
                           "--rtde", at(controller.rtde_port()), "--script", at(controller.script_port()),
                           "--dashboard", at(controller.dashboard_port()), "--send"});
    return all;
  }
  /// With doors, and a process that wants a person's word.
  std::vector<std::string> holding() const {
    std::ifstream coarse{coarse_process()};
    const std::string text{std::istreambuf_iterator<char>{coarse}, {}};
    // The gate's keys stand last in the file.
    const fs::path process = folder.write("held.yaml", text + "  approval: person\n");
    std::vector<std::string> all = sending(k_no_sensor);
    *(std::ranges::find(all, "--process") + 1) = process.string();
    all.insert(all.end(), {"--control", "tcp://127.0.0.1:0"});
    return all;
  }
  ChildProcess start(std::vector<std::string> all, const std::vector<std::string>& more) const {
    all.insert(all.end(), more.begin(), more.end());
    auto host = ChildProcess::start({.program = host_program(), .arguments = all, .pass_stderr = true});
    SUCCEEDS(host);
    return std::move(*host);
  }
  /// Its exit status and all that it said on stdout.
  static std::pair<int, std::string> end_of(ChildProcess & host) {
    std::string said;
    while (const auto line = host.next_line(k_patience)) said += *line + "\n";
    const auto status = host.wait(k_patience);
    SUCCEEDS(status);
    return {*status, said};
  }
  static nlohmann::json report_of(const fs::path& scan) {
    std::ifstream stream{scan / "report.json"};
    return nlohmann::json::parse(stream, nullptr, false);
  }
};

TEST(ServiceAndRobot, OldRecordingIsWorkedOutAndNeverSent) {
  const fs::path scan = leave_scan("scan-0001");
  ChildProcess host = start(sending(k_no_sensor), {"--once"});
  const auto [status, said] = end_of(host);
  LONGS_EQUAL(static_cast<int>(ExitStatus::Refused), status);
  STRCMP_CONTAINS("--confirm scan-0001", said.c_str());
  CHECK(fs::exists(scan / "line.csv"));
  CHECK(fs::exists(scan / "path/path.csv"));
  CHECK(controller.script().empty());
  STRCMP_CONTAINS("scan_not_seen", reasons_of(scan).c_str());
  CHECK(fs::exists(scan / "scan.btln"));  // a person may still say so
}

TEST(ServiceAndRobot, OldRecordingIsSentWhenAPersonSaysItsNameAndNoOther) {
  leave_scan("scan-0001");
  ChildProcess other = start(sending(k_no_sensor), {"--once", "--confirm", "scan-0002"});
  LONGS_EQUAL(static_cast<int>(ExitStatus::Refused), end_of(other).first);
  CHECK(controller.script().empty());
  // It has a report by now; the name brings it up again.
  ChildProcess named = start(sending(k_no_sensor), {"--once", "--confirm", "scan-0001"});
  static_cast<void>(end_of(named));  // this controller never begins the program
  STRCMP_CONTAINS("def biteline_path():", controller.script().c_str());
  const nlohmann::json gate = gate_of(results() / "scan-0001");
  CHECK(gate.value("permitted", false));
  CHECK(!gate["inputs"]["scan"]["confirmed"].value("by", "").empty());
  CHECK(!gate["inputs"]["scan"]["confirmed"].value("at", "").empty());
}

TEST(ServiceAndRobot, WordCountsForOneSending) {
  leave_scan("scan-0001");
  ChildProcess first = start(sending(k_no_sensor), {"--once", "--confirm", "scan-0001", "--keep-recording"});
  static_cast<void>(end_of(first));
  const std::string sent = controller.script();
  CHECK(!sent.empty());
  for (int again = 0; again < 2; ++again) {
    ChildProcess second =
        start(sending(k_no_sensor), {"--once", "--confirm", "scan-0001", "--keep-recording"});
    LONGS_EQUAL(static_cast<int>(ExitStatus::Refused), end_of(second).first);
    STRCMP_CONTAINS("sent_before", reasons_of(results() / "scan-0001").c_str());
  }
  CHECK_EQUAL(sent, controller.script());
}

TEST(ServiceAndRobot, ArmInLocalControlOrAnotherArmIsSentNothing) {
  leave_scan("scan-0001");
  controller.answers["is in remote control"] = "false";
  controller.answers["get robot model"] = "UR10";
  ChildProcess host =
      start(sending(k_no_sensor), {"--once", "--confirm", "scan-0001", "--serial", "20215500002"});
  const auto [status, said] = end_of(host);
  LONGS_EQUAL(static_cast<int>(ExitStatus::Refused), status);
  const std::string reasons = reasons_of(results() / "scan-0001");
  for (const char* reason : {"not_remote", "other_arm", "other_serial"})
    STRCMP_CONTAINS(reason, reasons.c_str());
  CHECK(reasons.find("scan_") == std::string::npos);
  CHECK(controller.script().empty());
}

TEST(ServiceAndRobot, ScanOfARecordingIsNotSent) {
  const auto sensor = recorded().sensor_of_it();
  ChildProcess host = start(sending(sensor.endpoint().text()), {"--once"});
  const auto [status, said] = end_of(host);
  LONGS_EQUAL(static_cast<int>(ExitStatus::Refused), status);
  STRCMP_CONTAINS("of a recording", said.c_str());
  CHECK(controller.script().empty());
}

TEST(ServiceAndRobot, ScanThatKilledTheServiceIsSetAsideAndTheNextOneGoesOn) {
  const fs::path deadly = leave_scan("scan-0001"), next = leave_scan("scan-0002");
  {
    ChildProcess host = start(arguments(k_no_sensor), {});
    while (host.running() && !fs::exists(deadly / "scan.attempt")) std::this_thread::yield();
    ::kill(host.pid(), SIGSEGV);
    SUCCEEDS(host.wait(k_patience));
  }
  CHECK(!fs::exists(deadly / "report.json"));
  ChildProcess successor = start(arguments(k_no_sensor), {"--once"});
  const auto [status, said] = end_of(successor);
  LONGS_EQUAL(static_cast<int>(ExitStatus::Done), status);
  STRCMP_CONTAINS("scan-0001 is set aside", said.c_str());
  STRCMP_EQUAL("scan_set_aside", report_of(deadly).value("reason_code", "").c_str());
  CHECK(fs::exists(deadly / "scan.btln"));
  CHECK(fs::exists(next / "line.csv"));
}

TEST(ServiceAndRobot, ScanThatIsSetAsideIsNotTouchedAgain) {
  const fs::path scan = leave_scan("scan-0001");
  std::ofstream{scan / "scan.attempt"} << "process 1\n";
  const auto sensor = recorded().sensor_of_it();
  for (int restart = 0; restart < 2; ++restart) {
    ChildProcess host = start(arguments(sensor.endpoint().text()), {"--once"});
    LONGS_EQUAL(static_cast<int>(ExitStatus::Done), end_of(host).first);
  }
  STRCMP_EQUAL("scan_set_aside", report_of(scan).value("reason_code", "").c_str());
  CHECK(!fs::exists(scan / "line.csv"));
  CHECK(fs::exists(results() / "scan-0003/line.csv"));
}

TEST(ServiceAndRobot, FolderThatCannotTakeTheResultCostsOneScanAndNotTheService) {
  const fs::path broken = leave_scan("scan-0001"), next = leave_scan("scan-0002");
  fs::create_directories(broken / "line.csv/in-the-way");  // no file can be written over it
  ChildProcess host = start(arguments(k_no_sensor), {});
  for (int i = 0; i < 6000 && !fs::exists(next / "line.csv"); ++i) std::this_thread::sleep_for(10ms);
  CHECK(fs::exists(next / "line.csv"));
  CHECK(host.running());
}

TEST(ServiceAndRobot, SecondServiceOnAFolderIsRefusedByTheFirstOnesName) {
  const auto sensor = recorded().sensor_of_it();
  ChildProcess first = start(arguments(sensor.endpoint().text()), {});
  SUCCEEDS(first.next_line(k_patience));
  ChildProcess second = start(arguments(sensor.endpoint().text()), {"--once"});
  LONGS_EQUAL(static_cast<int>(ExitStatus::Connection), end_of(second).first);
  STRCMP_CONTAINS(("held by biteline-host " + std::to_string(first.pid())).c_str(),
                  second.last_words().c_str());
}

TEST(ServiceAndRobot, SecondServiceOnAnArmIsRefusedByTheFirstOnesName) {
  const auto sensor = recorded().sensor_of_it();
  ChildProcess first = start(sending(sensor.endpoint().text()), {});
  SUCCEEDS(first.next_line(k_patience));
  std::vector<std::string> elsewhere = sending(sensor.endpoint().text());
  elsewhere[3] = (folder.path() / "other-results").string();
  ChildProcess second = start(elsewhere, {"--once"});
  LONGS_EQUAL(static_cast<int>(ExitStatus::Connection), end_of(second).first);
  STRCMP_CONTAINS(("held by biteline-host " + std::to_string(first.pid())).c_str(),
                  second.last_words().c_str());
}

/// A person at the page.
struct Page {
  std::unique_ptr<control::Client> client;
  std::string token;

  explicit Page(const std::string& address) {
    auto opened = control::Client::open(
        {.endpoint = *wire::parse_endpoint(address), .keys = {}, .patience = k_patience});
    SUCCEEDS(opened);
    client = std::move(*opened);
  }
  control::Answer ask(const std::string& method, const std::string& path, control::Json body = {}) const {
    control::Request request;
    request.token = token;
    request.local = true;
    request.method = method;
    request.path = "/api/v1" + path;
    request.body = std::move(body);
    return client->ask(std::move(request));
  }
  void begin() {
    const control::Json ada{{"name", "ada"}, {"password", "a long password"}};
    control::Json account = ada;
    account["role"] = "administrator";
    LONGS_EQUAL(201, ask("POST", "/users", account).status);
    token = ask("POST", "/sessions", ada).body["token"].get<std::string>();
    LONGS_EQUAL(200, ask("POST", "/control", {{"action", "take"}}).status);
  }
  /// A row is written by the result's thread, the phase is told after that thread's end.
  void wait_until_deciding() const {
    const auto until = std::chrono::steady_clock::now() + k_patience;
    std::string phase;
    do {
      phase = ask("GET", "/state").body["phase"].get<std::string>();
      if (phase == "deciding") return;
      std::this_thread::sleep_for(50ms);
    } while (std::chrono::steady_clock::now() < until);
    STRCMP_EQUAL("deciding", phase.c_str());
  }
  /// The scan's row, once `done` says so.
  template <class Done>
  control::Json scan_once(const std::string& name, Done&& done) const {
    const auto until = std::chrono::steady_clock::now() + k_patience;
    control::Json scan;
    do {
      std::this_thread::sleep_for(50ms);
      scan = ask("GET", "/scans/" + name).body;
    } while (!(scan.contains("decision") && done(scan)) && std::chrono::steady_clock::now() < until);
    CHECK_TEXT(scan.contains("decision"), scan.dump().c_str());
    return scan;
  }
};

std::string address_told(ChildProcess& host) {
  const std::string words = "doors come in at ";
  while (const auto line = host.next_line(k_patience)) {
    if (line->starts_with(words)) return line->substr(words.size());
  }
  FAIL("no address was told");
  return {};
}

TEST(ServiceAndRobot, HeldScanWaitsForAPersonAndTheGateStillJudges) {
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

  LONGS_EQUAL(200, page.ask("POST", "/scans/scan-0001/accept", {{"why", "looked at it"}}).status);
  const control::Json judged =
      page.scan_once("scan-0001", [](const control::Json& scan) { return scan["reason_code"].is_string(); });
  // A person's yes is not all that must hold: nobody saw this scan come in.
  STRCMP_EQUAL("scan_not_seen", judged["reason_code"].get<std::string>().c_str());
  STRCMP_EQUAL("accepted", judged["decision"].get<std::string>().c_str());
  STRCMP_EQUAL("ada", judged["decided_by"].get<std::string>().c_str());
  STRCMP_CONTAINS("ada",
                  gate_of(results() / "scan-0001")["inputs"]["result"].value("approved_by", "").c_str());
  CHECK(reasons_of(results() / "scan-0001").find("not_approved") == std::string::npos);
  CHECK(controller.script().empty());
  STRCMP_CONTAINS("accepted", page.ask("GET", "/log").body.dump().c_str());
}

TEST(ServiceAndRobot, KeptScanIsWorkedOutAgainBesideItsResultAndNothingIsSent) {
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

TEST(ServiceAndRobot, ScanOfNoKnownModelWaitsUntilAPersonNamesIt) {
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
  page.wait_until_deciding();
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

TEST(ServiceAndRobot, ScanOfNoKnownModelIsRefusedWhereNobodyCanBeAsked) {
  const fs::path scan = leave_scan("scan-0001");
  ChildProcess host =
      start(sending(k_no_sensor), {"--once", "--models", "--library", (folder.path() / "models").string()});
  LONGS_EQUAL(static_cast<int>(ExitStatus::Refused), end_of(host).first);
  STRCMP_EQUAL("model_unknown", report_of(scan).value("reason_code", "").c_str());
  CHECK(!fs::exists(scan / "line.csv"));
  CHECK(controller.script().empty());
}

TEST(ServiceAndRobot, RejectedScanKeepsItsReasonAndAnotherServiceRemembersIt) {
  leave_scan("scan-0001");
  {
    ChildProcess host = start(holding(), {});
    Page page{address_told(host)};
    page.begin();
    static_cast<void>(
        page.scan_once("scan-0001", [](const control::Json& scan) { return scan["decision"] == "held"; }));
    page.wait_until_deciding();
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

TEST(ServiceAndRobot, StopAtTheCellNeedsNoLoginAndEndsThePlansOfTheService) {
  ChildProcess host = start(holding(), {});
  Page page{address_told(host)};
  LONGS_EQUAL(200, page.ask("POST", "/commands/stop").status);
  page.begin();
  const auto until = std::chrono::steady_clock::now() + k_patience;
  while (page.ask("GET", "/state").body["phase"] != "stopped" && std::chrono::steady_clock::now() < until)
    std::this_thread::sleep_for(50ms);
  STRCMP_EQUAL("stopped", page.ask("GET", "/state").body["phase"].get<std::string>().c_str());
  LONGS_EQUAL(202, page.ask("POST", "/commands/start").status);
  while (page.ask("GET", "/state").body["phase"] == "stopped" && std::chrono::steady_clock::now() < until)
    std::this_thread::sleep_for(50ms);
  // Without a sensor it is not running either, and says so.
  STRCMP_EQUAL("fault", page.ask("GET", "/state").body["phase"].get<std::string>().c_str());
}

}  // namespace biteline
