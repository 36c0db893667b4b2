// SPDX-License-Identifier: MIT
// What was looked at is what is sent: a file that another program wrote since is told by name, and not sent.
#include <CppUTest/TestHarness.h>

#include <csignal>

#include "host/cloud/closed_line.hpp"
#include "tests/integration/robot/person.hpp"
#include "tests/support/json.hpp"

namespace biteline {
namespace {

bool held(const control::Json& row) {
  return row["decision"] == "held";
}

}  // namespace

/// A scan that waits for a word, and that somebody vouches for: nothing but its files can stop it.
struct HeldScan : ServiceWithArm {
  fs::path scan;
  std::optional<ChildProcess> host;
  std::optional<Page> page;

  void hold() {
    scan = leave_scan("scan-0001");
    std::ifstream coarse{coarse_process()};
    fs::create_directories(results() / "processes");
    std::ofstream{results() / "processes/coarse.yaml"} << coarse.rdbuf();
    host.emplace(start(
        holding(), {"--models", "--library", (folder.path() / "models").string(), "--confirm", "scan-0001"}));
    page.emplace(address_told(*host));
    page->begin();
    static_cast<void>(page->scan_once("scan-0001", held));
    page->wait_until_deciding();
    take_process();
    CHECK(page->ask("GET", "/state").body["held"]["sendable"].get<bool>());
  }
  control::Json take_process() {
    LONGS_EQUAL(202, page->ask("POST", "/scans/scan-0001/process", {{"process", "coarse"}}).status);
    // From the word on nothing is held until it is planned.
    const auto until = std::chrono::steady_clock::now() + k_patience;
    while (page->ask("GET", "/state").body["held"].is_null() && std::chrono::steady_clock::now() < until)
      std::this_thread::sleep_for(10ms);
    page->wait_until_deciding();
    return page->ask("GET", "/scans/scan-0001").body;
  }
  void not_accepted(const char* file) {
    const control::Answer answer = page->ask("POST", "/scans/scan-0001/accept");
    LONGS_EQUAL_TEXT(409, answer.status, file);
    STRCMP_CONTAINS(file, test::text_of(answer.body).c_str());
    CHECK(!fs::exists(scan / "gate.json"));
    CHECK(controller.script().empty());
  }
  /// The line 1.8 mm up, and as sure as a text editor wants it.
  void edit_line() const {
    auto line = cloud::read_line(scan / "line.csv");
    SUCCEEDS(line);
    for (cloud::LinePoint& point : line->points) {
      point.position.z() += 1.8;
      point.u95_mm = 0.01;
    }
    SUCCEEDS(cloud::write_line(scan / "line.csv", *line));
  }
  void append(const char* file) const { std::ofstream{scan / file, std::ios::app} << "\n"; }
};

TEST_GROUP_BASE(ServiceEvidence, HeldScan){};

TEST(ServiceEvidence, ALineOfATextEditorIsToldByNameAndNeitherPlannedNorSentNorMended) {
  hold();
  const control::Json before = page->ask("GET", "/scans/scan-0001").body;
  edit_line();
  not_accepted("line.csv was changed since the service wrote it");
  // Nor does another process launder it, as this would read the line from its file.
  const control::Json row = take_process();
  STRCMP_EQUAL("files_changed", row["reason_code"].get<std::string>().c_str());
  STRCMP_CONTAINS("line.csv was changed", row["reason"].get<std::string>().c_str());
  CHECK(row["u95_mm"] == before["u95_mm"]);
  CHECK(!fs::exists(scan / "path/path.csv"));
  not_accepted("");
  const control::Json steps = control::Json::array({{{"step", "candidate"}, {"candidate", 1}}});
  const control::Answer mended =
      page->ask("POST", "/scans/scan-0001/mend", {{"line_version", 0}, {"why", "x"}, {"steps", steps}});
  LONGS_EQUAL(409, mended.status);
  STRCMP_CONTAINS("line.csv was changed", test::text_of(mended.body).c_str());
}

TEST(ServiceEvidence, CloudReportAndProcessAreToldByNameToo) {
  hold();
  for (const char* file : {"cloud.ply", "report.json", "process.yaml"}) {
    std::ifstream stream{scan / file, std::ios::binary};
    const std::string text{std::istreambuf_iterator<char>{stream}, {}};
    append(file);
    not_accepted(file);
    std::ofstream{scan / file, std::ios::binary} << text;
  }
  fs::rename(scan / "line.csv", scan / "away.csv");
  not_accepted("line.csv is gone");
  fs::rename(scan / "away.csv", scan / "line.csv");
  // The process in its own place, as an engineer saves it between look and yes: the gate says no, and it
  // waits.
  std::ofstream{results() / "processes/coarse.yaml", std::ios::app} << "# another day\n";
  LONGS_EQUAL(200, page->ask("POST", "/scans/scan-0001/accept").status);
  static_cast<void>(page->scan_once("scan-0001", [](const control::Json& row) {
    return row["reason_code"] == "files_changed" && held(row);
  }));
  page->wait_until_deciding();
  STRCMP_CONTAINS("the process file was changed",
                  page->ask("GET", "/state").body["held"].value("reason", "").c_str());
  CHECK(controller.script().empty());
  // Chosen again it is what was looked at.
  static_cast<void>(take_process());
  CHECK(page->ask("GET", "/state").body["held"]["sendable"].get<bool>());
  // A yes of a page that still shows the version before is none.
  const std::string version = page->ask("GET", "/state").body["held"].value("version", "");
  CHECK(!version.empty());
  LONGS_EQUAL(409, page->ask("POST", "/scans/scan-0001/accept", {{"version", "0123456789abcdef"}}).status);
  LONGS_EQUAL(200, page->ask("POST", "/scans/scan-0001/accept", {{"version", version}}).status);
  page->scan_once("scan-0001", [](const control::Json& row) { return row["sent"].get<bool>(); });
  const nlohmann::json gate = gate_of(scan);
  CHECK_TEXT(gate.value("permitted", false), reasons_of(scan).c_str());
  for (const char* file : {"line", "cloud", "report", "process"}) {
    const std::string name = file;
    const auto& files = gate["inputs"]["files"];
    LONGS_EQUAL(64, files.value(name + "_sha256", "").size());
    STRCMP_EQUAL(files.value(name + "_sha256", "").c_str(), files.value(name + "_now_sha256", "").c_str());
  }
}

/// `biteline line edit`, while no service runs, is a person's version with who and why; a text editor's is
/// none.
TEST(ServiceEvidence, ALineThatLineEditMadeIsMendedOnAndOneOfATextEditorIsNot) {
  hold();
  ::kill(host->pid(), SIGKILL);
  SUCCEEDS(host->wait(k_patience));
  auto edit =
      ChildProcess::start({.program = host_program().parent_path() / "biteline",
                           .arguments = {"line", "edit", scan.string(), "--candidate", "1", "--why", "tried"},
                           .pass_stderr = true});
  SUCCEEDS(edit);
  const auto [status, said] = end_of(*edit);
  LONGS_EQUAL_TEXT(static_cast<int>(ExitStatus::Done), status, said.c_str());
  host.emplace(start(holding(), {}));
  page.emplace(address_told(*host));
  page->token = page->ask("POST", "/sessions", {{"name", "ada"}, {"password", "a long password"}})
                    .body["token"]
                    .get<std::string>();
  LONGS_EQUAL(200, page->ask("POST", "/control", {{"action", "take"}}).status);
  const auto mend = [&](int version) {
    const control::Json steps = control::Json::array({{{"step", "candidate"}, {"candidate", 1}}});
    return page->ask("POST", "/scans/scan-0001/mend",
                     {{"line_version", version}, {"why", "x"}, {"steps", steps}});
  };
  const control::Answer mended = mend(1);
  LONGS_EQUAL_TEXT(200, mended.status, test::text_of(mended.body).c_str());
  LONGS_EQUAL(2, mended.body["line_version"].get<int>());
  // What the mend wrote is what the service knows now.
  LONGS_EQUAL(200, mend(2).status);
  edit_line();
  LONGS_EQUAL(409, mend(3).status);
}

}  // namespace biteline
