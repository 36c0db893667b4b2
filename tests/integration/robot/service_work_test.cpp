// SPDX-License-Identifier: MIT
// The service looks at what it worked: a simulated arm lays glue on a made shoe, with a gap, and each scan
// sees what lies there by then.
#include "host/records/force_book/force_book.hpp"
#include "tests/integration/robot/work_cell.hpp"

namespace biteline {

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
  const std::string said = all_until_a_person_must_look();
  CHECK_TEXT(said.find("scan-0002") == std::string::npos, said.c_str());
  const memory::Scan kept = row();
  STRCMP_EQUAL_TEXT("work_ran_out", kept.reason_code.c_str(), said.c_str());
  STRCMP_CONTAINS("the gun may be empty", kept.reason.c_str());
  // At 160 mm/s at most some 320 mm were laid.
  CHECK_COMPARE(kept.work.missing_mm.value_or(0), >, 150);
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

/// A film that is too thin is not called worked; nothing goes on until somebody has looked.
ORDINARY_TIMED_TEST(ServiceWorkLong, AGunThatClogsIsAPersons) {
  begin_cell({"gun", "1.5", "0.15"});
  const std::string said = all_until_a_person_must_look();
  const memory::Scan kept = row(fs::exists(results() / "scan-0002") ? "scan-0002" : "scan-0001");
  CHECK_TEXT(kept.work.verdict == "faulty" || kept.work.verdict == "unsure", said.c_str());
  CHECK(!kept.reason_code.empty());
}

}  // namespace biteline
