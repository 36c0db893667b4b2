// SPDX-License-Identifier: MIT
// The service looks at what it worked: a simulated arm lays glue on a made shoe, with a gap, and each scan
// sees what lies there by then.
#include <CppUTest/TestHarness.h>

#include <csignal>
#include <fstream>
#include <nlohmann/json.hpp>

#include "host/records/force_book/force_book.hpp"
#include "host/records/memory/memory.hpp"
#include "tests/integration/robot/person.hpp"
#include "tests/support/timed_test.hpp"

namespace biteline {
namespace {

namespace fs = std::filesystem;

constexpr double k_gap_mm = 6;

}  // namespace

struct WorkedCell : Utest {
  test::TemporaryFolder folder;
  std::optional<ChildProcess> cell;
  nlohmann::json ports;
  std::string sensor;
  bool passes_stderr{true};  ///< else it is kept: ChildProcess::last_words()

  fs::path results() const { return folder.path() / "results"; }
  fs::path scan() const { return results() / "scan-0001"; }
  void begin_cell(std::vector<std::string> fault) {
    fault.insert(fault.begin(), (folder.path() / "truth").string());
    auto child = ChildProcess::start(
        {.program = BITELINE_WORKED_CELL, .arguments = std::move(fault), .pass_stderr = true});
    SUCCEEDS(child);
    cell.emplace(std::move(*child));
    const auto told = cell->next_line(k_patience), address = cell->next_line(k_patience);
    SUCCEEDS(told);
    SUCCEEDS(address);
    ports = test::read_json(*told);
    sensor = *address;
  }
  /// Quick cement above the line, on what a quick scan is good to; watched as a loaded machine can.
  std::string process(const std::string& gate, const std::string& more, const std::string& tool) const {
    std::ifstream stream{fs::path{BITELINE_PROCESSES} / "cement.yaml"};
    std::string text{std::istreambuf_iterator<char>{stream}, {}};
    for (const auto& [asked, instead] :
         {std::pair<std::string, std::string>{"start: auto",
                                              "start: auto\nafter_work: rework\nfollow: {covered: 0.5}"},
          {"up_mm: 2", "up_mm: 5"},
          {"contact_width_mm: 10", "contact_width_mm: 6"},
          {"\n  speed_mm_s: 80", "\n  speed_mm_s: 160"},
          {"\n  tolerance_mm: 1 ", "\n  tolerance_mm: 20 "},
          {"\n  tip_tolerance_mm: 2 ", "\n  tip_tolerance_mm: 20 "}}) {
      const std::size_t at = text.find(asked);
      CHECK_TEXT(at != std::string::npos, asked.c_str());
      text.replace(at, asked.size(), instead);
    }
    text.insert(text.find("  tcp_position_mm"), tool);
    return more + text + gate;
  }
  /// Grinding with a set force, on what a quick scan is good to.
  fs::path pressing_process() const {
    std::ifstream stream{fs::path{BITELINE_PROCESSES} / "grind_force.yaml"};
    std::string text{std::istreambuf_iterator<char>{stream}, {}};
    for (const auto& [asked, instead] :
         {std::pair<std::string, std::string>{"start: auto", "start: auto\nfollow: {covered: 0.5}"},
          {"\n  tolerance_mm: 1 ", "\n  tolerance_mm: 20 "},
          {"\n  tip_tolerance_mm: 2 ", "\n  tip_tolerance_mm: 20 "}}) {
      const std::size_t at = text.find(asked);
      CHECK_TEXT(at != std::string::npos, asked.c_str());
      text.replace(at, asked.size(), instead);
    }
    return folder.write("grind_force.yaml", text);
  }
  /// Saved at the cell; its tool's keys begin with `tool`.
  void save_second(const std::string& tool, const std::string& more = {}) const {
    fs::create_directories(results() / "processes");
    std::string text = process({}, more, tool);
    const std::string name = "name: cement";
    text.replace(text.find(name), name.size(), "name: second film");
    std::ofstream{results() / "processes/second.yaml"} << text;
  }
  static std::string not_sendable(const Page& page) {
    const control::Json held = page.ask("GET", "/state").body["held"];
    return held.is_object() && held["reason_code"].is_string() ? held["reason_code"] : "";
  }
  static void until_sendable(const Page& page) {
    const auto until = std::chrono::steady_clock::now() + k_patience;
    while (!not_sendable(page).empty() && std::chrono::steady_clock::now() < until)
      std::this_thread::sleep_for(50ms);
    STRCMP_EQUAL("", not_sendable(page).c_str());
  }
  static int accept(const Page& page, const std::string& name) {
    const control::Json held = page.ask("GET", "/state").body["held"];
    return page.ask("POST", "/scans/" + name + "/accept", {{"version", held["version"]}}).status;
  }
  /// `keys` of the process beside its gate's, and `tool` of its tool.
  ChildProcess start(const std::vector<std::string>& more, const std::string& gate = {},
                     const std::string& keys = {}, const std::string& tool = {}) const {
    return start_with(folder.write("cement.yaml", process(gate, keys, tool)), more);
  }
  ChildProcess start_with(const fs::path& process, const std::vector<std::string>& more) const {
    const auto at = [&](const char* port) { return "127.0.0.1:" + std::to_string(ports[port].get<int>()); };
    std::vector<std::string> all{"--sensor",
                                 sensor,
                                 "--out",
                                 results().string(),
                                 "--robot",
                                 "UR10e",
                                 "--process",
                                 process.string(),
                                 "--fixture-z",
                                 std::to_string(ports["fixture_z_mm"].get<double>()),
                                 "--fixture-beyond",
                                 std::to_string(ports["fixture_beyond_mm"].get<double>()),
                                 "--rtde",
                                 at("rtde"),
                                 "--script",
                                 at("script"),
                                 "--dashboard",
                                 at("dashboard"),
                                 "--send"};
    all.insert(all.end(), more.begin(), more.end());
    auto host =
        ChildProcess::start({.program = host_program(), .arguments = all, .pass_stderr = passes_stderr});
    SUCCEEDS(host);
    return std::move(*host);
  }
  static std::pair<int, std::string> end_of(ChildProcess& host) { return ServiceWithArm::end_of(host); }
  nlohmann::json file(const char* name, const char* of = "scan-0001") const {
    std::ifstream stream{results() / of / name};
    return test::read_json(stream);
  }
  memory::Scan row(const char* name = "scan-0001") const {
    const auto memory = memory::Memory::open_to_read(results() / memory::k_memory_file);
    SUCCEEDS(memory);
    const auto row = memory->scan(name);
    CHECK(row && *row);
    return **row;
  }
  /// Places of the true line, 0.5 mm apart, as the last scan saw them.
  std::vector<double> layers() const {
    std::ifstream stream{folder.path() / "truth/worked.csv"};
    std::vector<double> laid;
    for (std::string line; std::getline(stream, line);)
      if (!line.empty() && line[0] != '#') laid.push_back(std::stod(line.substr(line.rfind(',') + 1)));
    return laid;
  }
};

TEST_GROUP_BASE(ServiceWork, WorkedCell){};

/// A rework is a result of its own, behind the one that it mends.
ORDINARY_TIMED_TEST(ServiceWork, AGapIsFoundAndWorkedOnceMore) {
  begin_cell({std::to_string(k_gap_mm), "1"});
  ChildProcess host = start({"--once"});
  const auto [status, said] = end_of(host);
  LONGS_EQUAL_TEXT(static_cast<int>(ExitStatus::Done), status, said.c_str());
  STRCMP_EQUAL("work_faulty", file("work/look-1/report.json").value("reason_code", "").c_str());
  LONGS_EQUAL(1, file("work/look-1/report.json")["work"]["faults"].size());
  LONGS_EQUAL(1, file("rework.json")["reworks"].size());
  const memory::Scan kept = row(), again = row("scan-0002");
  STRCMP_EQUAL("faulty", kept.work.verdict.c_str());
  CHECK(kept.work.reworked && kept.sent && kept.followed.value_or(false));
  DOUBLES_EQUAL(k_gap_mm, kept.work.missing_mm.value_or(-1), 2);
  // Nobody is to do anything about it.
  STRCMP_EQUAL("", kept.reason_code.c_str());
  const nlohmann::json follows = file("report.json", "scan-0002")["follows"];
  STRCMP_EQUAL("scan-0001", follows.value("scan", "").c_str());
  LONGS_EQUAL(1, follows.value("rework_pieces", 0));
  CHECK(file("gate.json", "scan-0002").value("permitted", false));
  STRCMP_EQUAL("look", file("gate.json", "scan-0002")["inputs"]["scan"]["unmoved"].value("by", "").c_str());
  // It tells of all of the band, and not of the piece alone.
  STRCMP_EQUAL("ok", file("work/look-1/report.json", "scan-0002").value("status", "").c_str());
  STRCMP_EQUAL("ok", again.work.verdict.c_str());
  CHECK(again.followed.value_or(false) && !again.work.reworked);
  DOUBLES_EQUAL(0, again.work.missing_mm.value_or(-1), 1e-9);
  STRCMP_EQUAL("", again.reason_code.c_str());
  STRCMP_EQUAL("scan-0001", again.follows.c_str());
  CHECK(!fs::exists(results() / "scan-0003"));
  // In truth, too: all is covered, and beside the seam no more than 1 mm at either end of the gap lies twice,
  // a profile's way and a place's in the truth taken off.
  double twice_mm = 0;
  const std::vector<double> laid = layers();
  CHECK(laid.size() > 500);
  for (const double here : laid) {
    CHECK_COMPARE(here, >, 0.9);
    twice_mm += here > 1.5 ? 0.5 : 0;
  }
  const double overlap_mm = 8;  // of cement.yaml
  CHECK_COMPARE(twice_mm, <, overlap_mm + 2 * (1 + 0.5 + 0.5));
}

ORDINARY_TIMED_TEST(ServiceWork, AShoeThatWasMovedIsNotWorkedAgain) {
  begin_cell({std::to_string(k_gap_mm), "1", "moved"});
  ChildProcess host = start({"--once"});
  const auto [status, said] = end_of(host);
  LONGS_EQUAL_TEXT(static_cast<int>(ExitStatus::Refused), status, said.c_str());
  STRCMP_CONTAINS("a person must look before the next scan", said.c_str());
  const memory::Scan kept = row();
  STRCMP_EQUAL("refused", kept.work.verdict.c_str());
  STRCMP_EQUAL("shoe_moved", kept.reason_code.c_str());
  CHECK(kept.followed.value_or(false));
  CHECK(!fs::exists(results() / "scan-0002"));
}

/// Nobody knows which shoe stands there: the arm rests until a person has looked.
ORDINARY_TIMED_TEST(ServiceWork, AServiceThatDiedBeforeTheLookWorksNothingAgain) {
  begin_cell({std::to_string(k_gap_mm), "1"});
  {
    ChildProcess host = start({});
    while (const auto line = host.next_line(k_patience))
      if (line->starts_with("the arm followed the line")) break;
    ::kill(host.pid(), SIGKILL);
    SUCCEEDS(host.wait(k_patience));
  }
  STRCMP_EQUAL("looking", file("work/work.json").value("verdict", "").c_str());
  ChildProcess again = start({});
  std::string said;
  while (const auto line = again.next_line(2s)) said += *line + "\n";
  STRCMP_CONTAINS("no scan is asked for before a person has looked", said.c_str());
  CHECK_TEXT(said.find("asks for a scan") == std::string::npos, said.c_str());
  const memory::Scan kept = row();
  STRCMP_EQUAL("not_looked", kept.work.verdict.c_str());
  STRCMP_EQUAL("work_not_looked_at", kept.reason_code.c_str());
}

/// More of the same gun would leave nothing either.
ORDINARY_TIMED_TEST(ServiceWork, AGunThatRunsEmptyIsNamedAndWorksNothingMore) {
  begin_cell({"gun", "2", "0"});
  ChildProcess host = start({});
  std::string said;
  while (const auto line = host.next_line(k_patience)) {
    said += *line + "\n";
    if (line->find("a person must look before the next scan") != std::string::npos) break;
  }
  // Its row comes then, and no other scan.
  while (const auto line = host.next_line(2s)) said += *line + "\n";
  CHECK_TEXT(said.find("scan-0002") == std::string::npos, said.c_str());
  const memory::Scan kept = row();
  STRCMP_EQUAL_TEXT("work_ran_out", kept.reason_code.c_str(), said.c_str());
  STRCMP_CONTAINS("the gun may be empty", kept.reason.c_str());
  // At 160 mm/s at most some 320 mm were laid.
  CHECK_COMPARE(kept.work.missing_mm.value_or(0), >, 150);
}

/// A film that is too thin is not called worked; nothing goes on until somebody has looked.
ORDINARY_TIMED_TEST(ServiceWork, AGunThatClogsIsAPersons) {
  begin_cell({"gun", "1.5", "0.15"});
  ChildProcess host = start({});
  std::string said;
  while (const auto line = host.next_line(k_patience)) {
    said += *line + "\n";
    if (line->find("a person must look before the next scan") != std::string::npos) break;
  }
  while (const auto line = host.next_line(2s)) said += *line + "\n";
  const memory::Scan kept = row(fs::exists(results() / "scan-0002") ? "scan-0002" : "scan-0001");
  CHECK_TEXT(kept.work.verdict == "faulty" || kept.work.verdict == "unsure", said.c_str());
  CHECK(!kept.reason_code.empty());
}

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

/// Its pieces are places along its look's line.
ORDINARY_TIMED_TEST(ServiceApprovedRework, TakesNoOtherProcess) {
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

ORDINARY_TIMED_TEST(ServiceWork, AStopDuringTheLookWorksNothingAgain) {
  begin_cell({std::to_string(k_gap_mm), "1"});
  ChildProcess host = start({"--control", "tcp://127.0.0.1:0"});
  Page page{address_told(host)};
  page.begin();
  while (const auto line = host.next_line(k_patience))
    if (line->starts_with("looks at what was done")) break;
  LONGS_EQUAL(200, page.ask("POST", "/commands/stop").status);
  const control::Json row = page.scan_once("scan-0001", [](const control::Json& one) {
    return one["work"].is_object() && one["work"].value("verdict", "") != "looking";
  });
  // As far as the look had come by then: nobody has looked, or what is missing is left.
  CHECK_TEXT(row["work"].value("verdict", "") != "ok", test::text_of(row).c_str());
  CHECK(!row["work"].value("reworked", true));
  const fs::path rework = results() / "scan-0002";
  CHECK(!fs::exists(rework / "gate.json") || !ServiceWithArm::gate_of(rework).value("permitted", true));
  STRCMP_EQUAL("stopped", page.ask("GET", "/state").body.value("phase", "").c_str());
}

/// Two films of one tool: each is a result of its own, and both lie on the shoe.
ORDINARY_TIMED_TEST(ServiceWork, TheNextProcessWorksTheSameShoe) {
  begin_cell({});
  save_second({});
  ChildProcess host = start({"--once"}, {}, "next_process: second\n");
  const auto [status, said] = end_of(host);
  LONGS_EQUAL_TEXT(static_cast<int>(ExitStatus::Done), status, said.c_str());
  const memory::Scan first = row(), second = row("scan-0002");
  STRCMP_EQUAL("ok", first.work.verdict.c_str());
  CHECK(first.followed.value_or(false) && second.followed.value_or(false));
  STRCMP_EQUAL("second film", second.process.c_str());
  STRCMP_EQUAL("ok", second.work.verdict.c_str());
  // The second look is compared with what the first one saw, and the second path is proved by it.
  const nlohmann::json gate = file("gate.json", "scan-0002");
  STRCMP_EQUAL("look", gate["inputs"]["scan"]["unmoved"].value("by", "").c_str());
  STRCMP_EQUAL("scan-0001", file("report.json", "scan-0002")["follows"].value("scan", "").c_str());
  CHECK(!fs::exists(results() / "scan-0003"));
  for (const double here : layers()) CHECK_COMPARE(here, >, 1.9);
}

/// Of a path that is sent without its tool the arm would not know where the tip is.
ORDINARY_TIMED_TEST(ServiceWork, AnotherToolWaitsUntilAPersonHasMountedIt) {
  begin_cell({});
  save_second("  name: gun_b\n");
  ChildProcess host =
      start({"--control", "tcp://127.0.0.1:0"}, {}, "next_process: second\n", "  name: gun_a\n");
  Page page{address_told(host)};
  page.begin();
  page.wait_until_deciding();
  // The first process's tool is not mounted either, as nobody has said so.
  STRCMP_EQUAL("tool_not_mounted", not_sendable(page).c_str());
  LONGS_EQUAL(409, accept(page, "scan-0001"));
  LONGS_EQUAL(200, page.ask("PUT", "/mounted/tool", {{"name", "gun_a"}}).status);
  until_sendable(page);
  LONGS_EQUAL(200, accept(page, "scan-0001"));
  page.scan_once("scan-0002", [](const control::Json& one) { return one["decision"] == "held"; });
  page.wait_until_deciding();
  STRCMP_EQUAL("tool_not_mounted", not_sendable(page).c_str());
  LONGS_EQUAL(409, accept(page, "scan-0002"));
  CHECK(!fs::exists(results() / "scan-0002/gate.json"));
  LONGS_EQUAL(200, page.ask("PUT", "/mounted/tool", {{"name", "gun_b"}}).status);
  until_sendable(page);
  LONGS_EQUAL(200, accept(page, "scan-0002"));
  const control::Json second = page.scan_once("scan-0002", [](const control::Json& one) {
    return one["work"].is_object() && one["work"]["verdict"] == "ok";
  });
  CHECK(second.value("followed", false));
  STRCMP_EQUAL("gun_b", file("gate.json", "scan-0002")["inputs"]["result"].value("mounted_tool", "").c_str());
}

/// Whoever starts it again must not have the first process on the shoe twice.
ORDINARY_TIMED_TEST(ServiceWork, AServiceThatDiedBetweenTwoProcessesWorksNothingAgain) {
  begin_cell({});
  save_second("  name: gun_b\n");
  const std::string next = "next_process: second\n", tool = "  name: gun_a\n";
  {
    ChildProcess host = start({"--control", "tcp://127.0.0.1:0"}, {}, next, tool);
    Page page{address_told(host)};
    page.begin();
    page.wait_until_deciding();
    LONGS_EQUAL(200, page.ask("PUT", "/mounted/tool", {{"name", "gun_a"}}).status);
    until_sendable(page);
    LONGS_EQUAL(200, accept(page, "scan-0001"));
    page.scan_once("scan-0002", [](const control::Json& one) { return one["decision"] == "held"; });
    ::kill(host.pid(), SIGKILL);
    SUCCEEDS(host.wait(k_patience));
  }
  ChildProcess again = start({"--control", "tcp://127.0.0.1:0"}, {}, next, tool);
  std::string said;
  while (const auto line = again.next_line(2s)) said += *line + "\n";
  STRCMP_CONTAINS("no scan is asked for before a person has looked", said.c_str());
  CHECK_TEXT(said.find("asks for a scan") == std::string::npos, said.c_str());
  STRCMP_EQUAL("sequence_cut", row().reason_code.c_str());
  STRCMP_CONTAINS("second film", row().reason.c_str());
  STRCMP_EQUAL("open", row("scan-0002").decision.c_str());
  CHECK(!row("scan-0002").sent);
}

/// The arm's own program ends without its host; what lies on the shoe nobody knows.
ORDINARY_TIMED_TEST(ServiceWork, AServiceThatDiedWhileTheNextProcessIsWorkedWorksNothingAgain) {
  begin_cell({});
  save_second({});
  const std::string next = "next_process: second\n";
  {
    ChildProcess host = start({"--control", "tcp://127.0.0.1:0"}, {}, next);
    Page page{address_told(host)};
    page.begin();
    const auto until = std::chrono::steady_clock::now() + k_patience;
    const auto second_is_worked = [&] {
      return fs::exists(results() / "scan-0002/gate.json") &&
             page.ask("GET", "/state").body["phase"] == "following";
    };
    while (!second_is_worked() && std::chrono::steady_clock::now() < until) std::this_thread::sleep_for(20ms);
    ::kill(host.pid(), SIGKILL);
    SUCCEEDS(host.wait(k_patience));
  }
  CHECK(!fs::exists(results() / "scan-0002/followed.json"));
  ChildProcess again = start({"--control", "tcp://127.0.0.1:0"}, {}, next);
  std::string said;
  while (const auto line = again.next_line(2s)) said += *line + "\n";
  STRCMP_CONTAINS("no scan is asked for before a person has looked", said.c_str());
  CHECK_TEXT(said.find("sends the path") == std::string::npos, said.c_str());
  STRCMP_EQUAL("work_not_looked_at", row("scan-0002").reason_code.c_str());
  CHECK(row("scan-0002").sent);
  STRCMP_EQUAL("ok", row().work.verdict.c_str());
}

TEST(ServiceWork, ProcessesThatDoNotGoTogetherAreRefusedBeforeAnythingMoves) {
  begin_cell({});
  const auto why = [this](const std::string& more) {
    passes_stderr = false;
    ChildProcess host = start({"--once"}, {}, more);
    SUCCEEDS(host.wait(k_patience));
    return host.last_words();
  };
  STRCMP_CONTAINS("no saved process 'third'", why("next_process: third\n").c_str());
  save_second({}, "next_process: second\n");
  STRCMP_CONTAINS("comes again", why("next_process: second\n").c_str());
  CHECK(!fs::exists(scan()));
}

TEST_GROUP_BASE(ServiceWorkLong, WorkedCell){};

/// Three shoes pressed by a whole service: the first one's model is not known, the second teaches, the third
/// is pressed with what it taught, and all of them are told.
ORDINARY_TIMED_TEST(ServiceWorkLong, ForceIsLearnedFromShoeToShoe) {
  begin_cell({"presses"});
  const fs::path process = pressing_process(), library = folder.path() / "models";
  const auto work = [&](const std::vector<std::string>& more) {
    ChildProcess host = start_with(process, more);
    const auto [status, said] = end_of(host);
    LONGS_EQUAL_TEXT(static_cast<int>(ExitStatus::Done), status, said.c_str());
  };
  const auto json = [&](const char* name) {
    std::ifstream stream{results() / name};
    return test::read_json(stream);
  };
  const auto learned = [&] {
    const auto memory = memory::Memory::open_to_read(results() / memory::k_memory_file);
    SUCCEEDS(memory);
    const auto all = force_book::read_all(*memory);
    SUCCEEDS(all);
    return *all;
  };
  work({"--once"});
  // The share that force mode keeps alone: below it the bench says 82.6 % of a worst shoe.
  CHECK_COMPARE(json("scan-0001/followed.json")["force"].value("within", 0.0), >, 0.8);
  CHECK(learned().empty());
  auto save = ChildProcess::start({.program = BITELINE_TOOL,
                                   .arguments = {"model", "--library", library.string(), "save", "boot",
                                                 scan().string(), "--process", process.string()}});
  SUCCEEDS(save);
  LONGS_EQUAL(0, save->wait(k_patience).value_or(-1));
  work({"--once", "--models", "--library", library.string()});
  LONGS_EQUAL(1, learned().size());
  STRCMP_EQUAL("boot", learned().front().of.model.c_str());
  LONGS_EQUAL(1, learned().front().learned.shoes);
  CHECK(!json("scan-0002/path/report.json")["force"].contains("learned"));
  work({"--once", "--models", "--library", library.string()});
  LONGS_EQUAL(1, json("scan-0003/path/report.json")["force"]["learned"].value("shoes", 0));
  LONGS_EQUAL(2, learned().front().learned.shoes);
  STRCMP_EQUAL("scan-0003", learned().front().shoes.back().scan.c_str());
}

ORDINARY_TIMED_TEST(ServiceWorkLong, WhatIsStillMissingAfterTheReworkIsAPersons) {
  begin_cell({std::to_string(k_gap_mm), "2"});
  ChildProcess host = start({"--once"});
  const auto [status, said] = end_of(host);
  LONGS_EQUAL_TEXT(static_cast<int>(ExitStatus::Review), status, said.c_str());
  const memory::Scan again = row("scan-0002");
  STRCMP_EQUAL("faulty", again.work.verdict.c_str());
  STRCMP_EQUAL("still_faulty", again.reason_code.c_str());
  CHECK(row().work.reworked);
  DOUBLES_EQUAL(k_gap_mm, again.work.missing_mm.value_or(0), 2);
  LONGS_EQUAL(1, file("rework.json")["reworks"].size());
  CHECK(!fs::exists(results() / "scan-0003"));
}

}  // namespace biteline
