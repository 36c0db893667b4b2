// SPDX-License-Identifier: MIT
// Teaching: another process for a scan that waits, and its first run in the air.
#include <CppUTest/TestHarness.h>

#include <csignal>

#include "tests/integration/robot/person.hpp"
#include "tests/support/json.hpp"

namespace biteline {

TEST_GROUP_BASE(ServiceTeach, ServiceWithArm){};

TEST(ServiceTeach, WaitingScanIsPlannedWithAnotherProcessAndRunInTheAirThroughTheSameGate) {
  const fs::path scan = leave_scan("scan-0001");
  ChildProcess host = start(holding(), {});
  Page page{address_told(host)};
  page.begin();
  const auto held = [](const control::Json& row) { return row["decision"] == "held"; };
  const std::string before = page.scan_once("scan-0001", held)["process"].get<std::string>();
  page.wait_until_deciding();
  LONGS_EQUAL(202, page.ask("POST", "/scans/scan-0001/process", {{"process", "cement"}}).status);
  // While it is planned nobody can say a word about it.
  LONGS_EQUAL(409, page.ask("POST", "/scans/scan-0001/air").status);
  LONGS_EQUAL(409, page.ask("POST", "/scans/scan-0001/accept").status);
  page.scan_once("scan-0001",
                 [&](const control::Json& row) { return row["process"] != before && held(row); });
  page.wait_until_deciding();
  CHECK(fs::exists(scan / "path/path.csv"));
  CHECK(page.ask("GET", "/scans/scan-0001").body["air"].is_null());

  LONGS_EQUAL(202, page.ask("POST", "/scans/scan-0001/air").status);
  const control::Json air = page.scan_once("scan-0001", [](const control::Json& row) {
    return row["air"].is_object() && row["air"]["state"] != "begun";
  })["air"];
  // Nobody saw this scan come in, so nothing moves in the air either.
  STRCMP_EQUAL("refused", air["state"].get<std::string>().c_str());
  STRCMP_EQUAL("scan_not_seen", air["reason_code"].get<std::string>().c_str());
  STRCMP_CONTAINS("ada", gate_of(scan / "air")["inputs"]["result"].value("approved_by", "").c_str());
  CHECK(fs::exists(scan / "air/path/path.csv"));
  page.wait_until_deciding();
  CHECK(!fs::exists(scan / "gate.json"));
  CHECK(controller.script().empty());
  // It waits as before, and a word about it counts.
  LONGS_EQUAL(200, page.ask("POST", "/scans/scan-0001/reject", {{"why", "only tried"}}).status);
  LONGS_EQUAL(409, page.ask("POST", "/scans/scan-0001/air").status);
}

/// A person vouches for the old scan's shoe: then it is judged like a fresh one.
TEST(ServiceTeach, RunInTheAirThatTheGateLetsThroughSendsOffAndNeverOn) {
  const fs::path scan = leave_scan("scan-0001");
  std::ifstream coarse{coarse_process()};
  fs::create_directories(results() / "processes");
  std::ofstream{results() / "processes/coarse.yaml"} << coarse.rdbuf();
  ChildProcess host = start(
      holding(), {"--models", "--library", (folder.path() / "models").string(), "--confirm", "scan-0001"});
  Page page{address_told(host)};
  page.begin();
  const auto held = [](const control::Json& row) { return row["decision"] == "held"; };
  static_cast<void>(page.scan_once("scan-0001", held));
  page.wait_until_deciding();
  LONGS_EQUAL(202, page.ask("POST", "/scans/scan-0001/process", {{"process", "coarse"}}).status);
  page.scan_once("scan-0001",
                 [&](const control::Json& row) { return row["reason_code"].is_null() && held(row); });
  page.wait_until_deciding();
  LONGS_EQUAL(202, page.ask("POST", "/scans/scan-0001/air").status);
  page.scan_once("scan-0001", [](const control::Json& row) {
    return row["air"].is_object() && row["air"]["state"] != "begun";
  });
  const nlohmann::json gate = gate_of(scan / "air");
  CHECK_TEXT(gate.value("permitted", false), reasons_of(scan / "air").c_str());
  // This controller never begins the program: the service ends it, with the tool's output off.
  page.wait_until_deciding();
  const std::string sent = controller.script();
  STRCMP_CONTAINS("def biteline_path():\n", sent.c_str());
  STRCMP_CONTAINS("set_standard_digital_out(0, False)", sent.c_str());
  CHECK(sent.find("True") == std::string::npos);
  CHECK(sent.find("digital_out") < sent.find("  move"));
  // What waits is the path itself, and nothing of it was sent.
  CHECK(!fs::exists(scan / "gate.json"));
  CHECK(held(page.ask("GET", "/scans/scan-0001").body));
}

/// Of what the next scan is worked with, page, state, row, path and arm say the same.
TEST(ServiceTeach, TheNextScanHasTheProcessThatAPersonTookAndSoHasTheStateAlsoAfterARestart) {
  leave_scan("scan-0001");
  const fs::path second = leave_scan("scan-0002");
  // Another process, and one that asks a person, too.
  std::ifstream coarse{coarse_process()};
  std::string text{std::istreambuf_iterator<char>{coarse}, {}};
  text.replace(text.find("name: grind"), 11, "name: taught") += "  approval: person\n";
  fs::create_directories(results() / "processes");
  std::ofstream{results() / "processes/taught.yaml"} << text;
  const auto process_in = [](const fs::path& scan) {
    std::ifstream stream{scan / "path/report.json"};
    return test::read_json(stream).value("process", "");
  };
  {
    ChildProcess host = start(holding(), {});
    Page page{address_told(host)};
    page.begin();
    const auto held = [](const control::Json& row) { return row["decision"] == "held"; };
    const std::string own = page.scan_once("scan-0001", held)["process"].get<std::string>();
    page.wait_until_deciding();
    CHECK(own != "taught");
    control::Json state = page.ask("GET", "/state").body;
    STRCMP_EQUAL(own.c_str(), state["process"].get<std::string>().c_str());
    CHECK(state["process_by"].is_null());
    LONGS_EQUAL(202, page.ask("POST", "/scans/scan-0001/process", {{"process", "taught"}}).status);
    page.scan_once("scan-0001", [&](const control::Json& row) { return row["process"] != own && held(row); });
    page.wait_until_deciding();
    LONGS_EQUAL(200, page.ask("POST", "/scans/scan-0001/reject", {{"why", "too old"}}).status);
    // The next one comes by itself, and nobody says its process again.
    const control::Json row = page.scan_once("scan-0002", held);
    STRCMP_EQUAL("taught", row["process"].get<std::string>().c_str());
    STRCMP_EQUAL("taught", process_in(second).c_str());
    page.wait_until_deciding();
    state = page.ask("GET", "/state").body;
    STRCMP_EQUAL("taught", state["process"].get<std::string>().c_str());
    STRCMP_EQUAL("ada", state["process_by"].get<std::string>().c_str());
    // What was planned lies beside it, byte by byte, and is what a model gets without being told.
    LONGS_EQUAL(
        409,
        page.ask("POST", "/models", {{"name", "wrong"}, {"scan", "scan-0002"}, {"process", "rough"}}).status);
    ::kill(host.pid(), SIGKILL);
    SUCCEEDS(host.wait(k_patience));
  }
  leave_scan("scan-0003");
  {
    ChildProcess host = start(holding(), {});
    Page page{address_told(host)};
    page.token = page.ask("POST", "/sessions", {{"name", "ada"}, {"password", "a long password"}})
                     .body["token"]
                     .get<std::string>();
    const auto held = [](const control::Json& row) { return row["decision"] == "held"; };
    STRCMP_EQUAL("taught", page.scan_once("scan-0003", held)["process"].get<std::string>().c_str());
    page.wait_until_deciding();
    LONGS_EQUAL(200, page.ask("POST", "/control", {{"action", "take"}}).status);
    LONGS_EQUAL(200, page.ask("POST", "/scans/scan-0003/reject", {{"why", "tried"}}).status);
    const auto process_until = [&](const std::string& wanted) {
      const auto until = std::chrono::steady_clock::now() + k_patience;
      std::string name;
      while (name != wanted && std::chrono::steady_clock::now() < until) {
        std::this_thread::sleep_for(50ms);
        name = page.ask("GET", "/state").body.value("process", "");
      }
      return name;
    };
    // A start that names none goes on with it; one that says so goes back to the service's own.
    LONGS_EQUAL(202, page.ask("POST", "/commands/start").status);
    std::this_thread::sleep_for(300ms);
    STRCMP_EQUAL("taught", process_until("taught").c_str());
    LONGS_EQUAL(202, page.ask("POST", "/commands/start", {{"process", ""}}).status);
    STRCMP_EQUAL("grind", process_until("grind").c_str());
    CHECK(page.ask("GET", "/state").body["process_by"].is_null());
  }
  CHECK(controller.script().empty());
}

TEST(ServiceTeach, AYesThatComesToNothingStartsNothingAndTheScanWaitsOn) {
  const fs::path scan = leave_scan("scan-0001"), next = leave_scan("scan-0002");
  controller.answers["is in remote control"] = "false";
  std::ifstream coarse{coarse_process()};
  fs::create_directories(results() / "processes");
  std::ofstream{results() / "processes/coarse.yaml"} << coarse.rdbuf();
  ChildProcess host = start(
      holding(), {"--models", "--library", (folder.path() / "models").string(), "--confirm", "scan-0001"});
  Page page{address_told(host)};
  page.begin();
  const auto held = [](const control::Json& row) { return row["decision"] == "held"; };
  static_cast<void>(page.scan_once("scan-0001", held));
  page.wait_until_deciding();
  LONGS_EQUAL(202, page.ask("POST", "/scans/scan-0001/process", {{"process", "coarse"}}).status);
  page.scan_once("scan-0001",
                 [&](const control::Json& row) { return row["reason_code"].is_null() && held(row); });
  page.wait_until_deciding();
  // A person vouches for it, so it may be accepted; the pendant is in local control.
  const control::Json waits = page.ask("GET", "/state").body["held"];
  CHECK_TEXT(waits["sendable"].get<bool>(), test::text_of(waits).c_str());
  for (int yes = 0; yes < 2; ++yes) {
    LONGS_EQUAL(200, page.ask("POST", "/scans/scan-0001/accept").status);
    const control::Json row = page.scan_once(
        "scan-0001", [&](const control::Json& now) { return now["reason_code"].is_string() && held(now); });
    STRCMP_EQUAL("not_remote", row["reason_code"].get<std::string>().c_str());
    page.wait_until_deciding();
    STRCMP_EQUAL("scan-0001", page.ask("GET", "/state").body["held"].value("scan", "").c_str());
  }
  // Taught between plan and word: the gate says no, and from then on a yes is not offered.
  const control::Json load{{"kg", 5}, {"centre_mm", control::Json::array({0, 0, 70})}};
  LONGS_EQUAL(200, page.ask("PUT", "/mounted/payload", load).status);
  LONGS_EQUAL(200, page.ask("POST", "/scans/scan-0001/accept").status);
  static_cast<void>(page.scan_once("scan-0001", [&](const control::Json& now) {
    return now["reason_code"] == "not_as_taught" && held(now);
  }));
  page.wait_until_deciding();
  LONGS_EQUAL(409, page.ask("POST", "/scans/scan-0001/accept").status);
  CHECK(fs::exists(scan / "scan.btln"));
  CHECK(!fs::exists(next / "report.json"));
  CHECK(controller.script().empty());
}

TEST(ServiceTeach, ScanOfNoKnownModelGoesOnWithAProcessAndStillWaits) {
  const fs::path scan = leave_scan("scan-0001");
  ChildProcess host = start(holding(), {"--models", "--library", (folder.path() / "models").string()});
  Page page{address_told(host)};
  page.begin();
  const auto held = [](const control::Json& row) { return row["decision"] == "held"; };
  static_cast<void>(page.scan_once("scan-0001", held));
  page.wait_until_deciding();
  LONGS_EQUAL(409, page.ask("POST", "/scans/scan-0001/air").status);
  // A process that sends by itself: what is taught waits for a person all the same.
  LONGS_EQUAL(202, page.ask("POST", "/scans/scan-0001/process", {{"process", "cement"}}).status);
  const control::Json row = page.scan_once(
      "scan-0001", [&](const control::Json& now) { return now["reason_code"].is_null() && held(now); });
  CHECK(row["model"].is_null());
  CHECK(fs::exists(scan / "path/path.csv"));
  page.wait_until_deciding();
  CHECK(!fs::exists(scan / "gate.json"));
  CHECK(controller.script().empty());
}

/// A person took a process for the shoe before, and this one is a model with a process of its own: neither is
/// used unseen, though nobody asked to hold it.
TEST(ServiceTeach, AScanOfAModelWithAnotherProcessThanTakenIsHeldAndSaysWhy) {
  leave_scan("scan-0001");
  leave_scan("scan-0002");
  std::ifstream coarse{coarse_process()};
  fs::create_directories(results() / "processes");
  std::ofstream{results() / "processes/coarse.yaml"} << coarse.rdbuf();
  ChildProcess host = start(holding(), {"--models", "--library", (folder.path() / "models").string()});
  Page page{address_told(host)};
  page.begin();
  const auto held = [](const control::Json& row) { return row["decision"] == "held"; };
  static_cast<void>(page.scan_once("scan-0001", held));
  page.wait_until_deciding();
  // coarse asks nobody: without another reason the next scan would not wait.
  LONGS_EQUAL(202, page.ask("POST", "/scans/scan-0001/process", {{"process", "coarse"}}).status);
  page.scan_once("scan-0001",
                 [&](const control::Json& row) { return row["reason_code"].is_null() && held(row); });
  page.wait_until_deciding();
  const control::Json boot{
      {"name", "boot"}, {"scan", "scan-0001"}, {"process", "cement"}, {"other_process", true}};
  LONGS_EQUAL(201, page.ask("POST", "/models", boot).status);
  LONGS_EQUAL(200, page.ask("POST", "/scans/scan-0001/reject", {{"why", "taught"}}).status);
  const control::Json row = page.scan_once("scan-0002", held);
  STRCMP_EQUAL("boot", row["model"].get<std::string>().c_str());
  STRCMP_EQUAL("other_process", row["reason_code"].get<std::string>().c_str());
  const std::string reason = row["reason"].get<std::string>();
  STRCMP_CONTAINS("the process of boot is cement", reason.c_str());
  STRCMP_CONTAINS("ada took", reason.c_str());
  STRCMP_CONTAINS("choose the model's process", row["next_step"].get<std::string>().c_str());
  // The word about this one settles it.
  page.wait_until_deciding();
  LONGS_EQUAL(202, page.ask("POST", "/scans/scan-0002/process", {{"process", "cement"}}).status);
  const control::Json settled = page.scan_once("scan-0002", [&](const control::Json& now) {
    return now["reason_code"] != "other_process" && held(now);
  });
  STRCMP_EQUAL("cement", settled["process"].get<std::string>().c_str());
  CHECK(controller.script().empty());
}

TEST(ServiceTeach, ProcessOfAnotherToolThanTaughtIsRefusedBeforeItsPathAndBeforeAYes) {
  const fs::path scan = leave_scan("scan-0001");
  ChildProcess host = start(holding(), {});
  Page page{address_told(host)};
  page.begin();
  const auto held = [](const control::Json& row) { return row["decision"] == "held"; };
  static_cast<void>(page.scan_once("scan-0001", held));
  page.wait_until_deciding();
  CHECK(fs::exists(scan / "path/path.csv"));
  // The arm is read where it stands; once it stands so it is one touch.
  const control::Answer touched = page.ask("POST", "/mounted/touches", {{"part", "tip"}});
  LONGS_EQUAL(200, touched.status);
  LONGS_EQUAL(1, touched.body["lesson"]["touches"].get<int>());
  DOUBLES_EQUAL(150, touched.body["controller"]["tip_mm"][2].get<double>(), 1e-6);
  LONGS_EQUAL(409, page.ask("POST", "/mounted/touches", {{"part", "tip"}}).status);
  LONGS_EQUAL(409, page.ask("PUT", "/mounted/tip").status);

  // Taught before it is planned: there is no path.
  const control::Json load{{"kg", 5}, {"centre_mm", control::Json::array({0, 0, 70})}};
  LONGS_EQUAL(200, page.ask("PUT", "/mounted/payload", load).status);
  LONGS_EQUAL(202, page.ask("POST", "/scans/scan-0001/process", {{"process", "cement"}}).status);
  static_cast<void>(page.scan_once(
      "scan-0001", [&](const control::Json& row) { return row["process"] == "cement" && held(row); }));
  page.wait_until_deciding();
  CHECK(!fs::exists(scan / "path/path.csv"));
  const auto report = [&] {
    std::ifstream stream{scan / "path/report.json"};
    return test::read_json(stream);
  }();
  STRCMP_EQUAL("not_as_taught", report.value("reason_code", "").c_str());
  STRCMP_EQUAL("path", page.ask("GET", "/state").body["held"]["waits_for"].get<std::string>().c_str());

  LONGS_EQUAL(200, page.ask("DELETE", "/mounted/payload").status);
  LONGS_EQUAL(202, page.ask("POST", "/scans/scan-0001/process", {{"process", "cement"}}).status);
  page.wait_until_deciding();
  static_cast<void>(page.scan_once("scan-0001", [&](const control::Json& row) {
    return held(row) && fs::exists(scan / "path/path.csv");
  }));
  page.wait_until_deciding();
  CHECK(controller.script().empty());
}

}  // namespace biteline
