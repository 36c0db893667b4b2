// SPDX-License-Identifier: MIT
// What is taught waits for a person: from the start on, and between its words.
#include <CppUTest/TestHarness.h>

#include <atomic>
#include <thread>

#include "host/apps/biteline-host/operator_control.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/host/apps/opened_operator_control.hpp"

namespace biteline::service {

TEST_GROUP(OperatorControlTeach) {
  test::TemporaryFolder folder;
  robot::Stops stops;
  std::unique_ptr<OperatorControl> sut;

  void open(bool with_arm) {
    OperatorControlConfig config;
    config.results = folder.path();
    config.arm = "UR5e";
    config.stops = &stops;
    if (with_arm) {
      config.rerun_arm =
          RerunArm{.model = *kinematics::arm_model("UR5e"),
                   .process = *path::read_process(std::filesystem::path{BITELINE_PROCESSES} / "rough.yaml"),
                   .table_z_mm = 0};
    }
    auto opened = OperatorControl::open(config);
    SUCCEEDS(opened);
    sut = std::move(*opened);
  }
  void teardown() override {
    sut.reset();
  }
  static void refused(const Result<void>& word) {
    CHECK(!word);
    CHECK(word.error().code == Errc::WrongState);
  }
  OperatorCommand::Kind next() const {
    const std::optional<OperatorCommand> command = sut->next_command();
    CHECK(command.has_value());
    return command->kind;
  }
};

TEST(OperatorControlTeach, AHoldOutlivesTheServiceAndAStartWithoutItEndsIt) {
  open(true);
  SUCCEEDS(sut->start({.model = {}, .process = {}, .hold = true}, "ada"));
  sut.reset();
  open(true);
  CHECK(sut->wants_hold("scan-0001"));
  const auto rows = sut->memory().log_rows(0, 1);
  SUCCEEDS(rows);
  STRCMP_EQUAL("hold every scan", rows->front().action.c_str());
  // A start that is refused takes nothing back.
  test::hold_worked(*sut, {.scan = "scan-0001"});
  refused(sut->start({}, "ada"));
  sut.reset();
  open(true);
  CHECK(sut->wants_hold("scan-0001"));
  SUCCEEDS(sut->start({}, "ada"));
  sut.reset();
  open(true);
  CHECK_FALSE(sut->wants_hold("scan-0001"));
}

TEST(OperatorControlTeach, AStartThatHoldsHoldsEveryScanUntilOneWithoutIt) {
  open(true);
  CHECK_FALSE(sut->wants_hold("scan-0001"));
  SUCCEEDS(sut->start({.model = {}, .process = {}, .hold = true}, "ada"));
  CHECK(sut->wants_hold("scan-0001"));
  CHECK(sut->wants_hold("scan-0002"));
  // A word about one scan takes nothing from the next.
  test::hold_worked(*sut, {.scan = "scan-0001"});
  sut->enter(CellEvent::Reject);
  CHECK(sut->wants_hold("scan-0002"));
  SUCCEEDS(sut->rescan({.who = "ada", .why = "again", .door = "web", .hold = true}));
  CHECK(sut->wants_hold("scan-0003"));
  SUCCEEDS(sut->rescan({.who = "ada", .why = "now it works", .door = "web", .hold = false}));
  CHECK_FALSE(sut->wants_hold("scan-0004"));
  SUCCEEDS(sut->start({.model = {}, .process = {}, .hold = true}, "ada"));
  SUCCEEDS(sut->start({}, "ada"));
  CHECK_FALSE(sut->wants_hold("scan-0005"));
  // One in work was asked for with it, and waits.
  SUCCEEDS(sut->start({.model = {}, .process = {}, .hold = true}, "ada"));
  sut->scan_begins("scan-0006");
  SUCCEEDS(sut->start({}, "ada"));
  CHECK(sut->wants_hold("scan-0006"));
  CHECK_FALSE(sut->wants_hold("scan-0007"));
}

TEST(OperatorControlTeach, ARunInTheAirNeedsACheckedPathThatWaits) {
  open(true);
  refused(sut->run_in_air("scan-0001", "ada"));
  refused(sut->choose_process("scan-0001", "rough", "ada"));
  test::hold_worked(*sut, {.scan = "scan-0001", .waits = Waits::ForPath});
  refused(sut->run_in_air("scan-0001", "ada"));
  test::hold_worked(*sut, {.scan = "scan-0001", .waits = Waits::ForModel});
  refused(sut->run_in_air("scan-0001", "ada"));
  test::hold_worked(*sut, {.scan = "scan-0001", .waits = Waits::ForWord, .fresh_s = 100});
  refused(sut->run_in_air("scan-0002", "ada"));
  SUCCEEDS(sut->begin_mend("scan-0001"));
  refused(sut->run_in_air("scan-0001", "ada"));
  refused(sut->choose_process("scan-0001", "rough", "ada"));
  sut->end_mend("scan-0001", false, "ada");
  SUCCEEDS(sut->run_in_air("scan-0001", "ada"));
  CHECK(next() == OperatorCommand::Kind::Air);
  // Until it waits again nobody can say a word about it.
  refused(sut->run_in_air("scan-0001", "ada"));
  refused(sut->choose_process("scan-0001", "rough", "ada"));
  refused(sut->start({}, "ada"));
  refused(sut->rescan({.who = "ada", .why = "again", .door = "web", .hold = false}));
  memory::Scan row;
  row.name = "scan-0001";
  row.time = 1;
  row.verdict = "ok";
  row.decision = "held";
  SUCCEEDS(sut->memory().put_scan(row, memory::LogRow{}));
  const api::Decision no{
      .kind = api::Decision::Kind::Reject, .scan = "scan-0001", .who = "ada", .why = "no", .door = "web"};
  refused(sut->decide(no));
  refused(sut->begin_mend("scan-0001"));
  CHECK(!sut->next_command());
  test::hold_worked(*sut, {.scan = "scan-0001", .waits = Waits::ForModel});
  SUCCEEDS(sut->choose_process("scan-0001", "rough", "ada"));
  CHECK(next() == OperatorCommand::Kind::Process);
  refused(sut->decide(no));
  test::hold_worked(*sut, {.scan = "scan-0001"});
  SUCCEEDS(sut->decide(no));
  CHECK(next() == OperatorCommand::Kind::Reject);
}

/// However often somebody starts and stops while the service is busy.
TEST(OperatorControlTeach, NoWordIsLostBehindManyOthersAndTheLastOfAKindCounts) {
  open(true);
  const auto start_with = [this](int i) {
    return sut->start({.model = {}, .process = std::string{"p"} + std::to_string(i)}, {"ada", stops.count()});
  };
  for (int i = 0; i < 199; ++i) {
    SUCCEEDS(start_with(i));
    sut->laser_off("ada");
    sut->stop("ada");
  }
  SUCCEEDS(start_with(199));
  test::hold_worked(*sut, {.scan = "scan-0001"});
  SUCCEEDS(sut->choose_process("scan-0001", "rough", {"ada", stops.count()}));
  CHECK(next() == OperatorCommand::Kind::LaserOff);
  CHECK(next() == OperatorCommand::Kind::Stop);
  const std::optional<OperatorCommand> start = sut->next_command();
  CHECK(start && start->kind == OperatorCommand::Kind::Start);
  STRCMP_EQUAL("p199", start->job.process.c_str());
  CHECK(next() == OperatorCommand::Kind::Process);
  CHECK(!sut->next_command());
}

TEST(OperatorControlTeach, AHoldStaysOneWhenTheModelIsNamed) {
  open(true);
  test::work(*sut, "scan-0001");
  SUCCEEDS(sut->decide({.kind = api::Decision::Kind::Hold,
                        .scan = "scan-0001",
                        .who = "ada",
                        .why = "let me see it",
                        .door = "web"}));
  test::hold_worked(*sut, {.scan = "scan-0001", .waits = Waits::ForModel});
  SUCCEEDS(sut->choose_model("scan-0001", "boot", "ada"));
  CHECK(sut->wants_hold("scan-0001"));
}

TEST(OperatorControlTeach, AHoldThatComesTooLateIsToldSo) {
  using enum api::Decision::Kind;
  open(true);
  const api::Decision hold{.kind = Hold, .scan = "scan-0001", .who = "ada", .why = "wait", .door = "web"};
  test::work(*sut, "scan-0001");
  CHECK_FALSE(sut->wants_hold_at_last("scan-0001"));
  FAILS_NAMING(Errc::WrongState, "too late to hold scan-0001; stop the arm", sut->decide(hold));
  CHECK_FALSE(sut->wants_hold("scan-0001"));
  // It says nothing of the next one.
  sut->scan_begins("scan-0002");
  api::Decision next = hold;
  next.scan = "scan-0002";
  SUCCEEDS(sut->decide(next));
  CHECK(sut->wants_hold_at_last("scan-0002"));
}

/// Whoever is answered "held" sees it held, at whatever moment he says so.
TEST(OperatorControlTeach, AHoldBesideTheLastLookIsEitherHeededOrRefused) {
  using enum api::Decision::Kind;
  open(true);
  int handled = 0;
  for (int round = 0; round < 200; ++round) {
    const std::string scan = "scan-" + std::to_string(1000 + round);
    test::work(*sut, scan);
    std::atomic<bool> go{false};
    bool taken = false;
    std::thread person{[&] {
      while (!go) std::this_thread::yield();
      taken = sut->decide({.kind = Hold, .scan = scan, .who = "ada", .why = "so", .door = "web"}).has_value();
    }};
    go = true;
    if (round % 4 == 0) person.join();
    for (int wait = 0; wait < round; ++wait) std::this_thread::yield();
    const bool held = sut->wants_hold_at_last(scan);
    if (person.joinable()) person.join();
    CHECK_EQUAL_TEXT(taken, held, scan.c_str());
    handled += held ? 1 : 0;
  }
  CHECK(handled >= 50);
}

TEST(OperatorControlTeach, NothingIsPlannedWithoutAnArm) {
  open(false);
  test::hold_worked(*sut, {.scan = "scan-0001"});
  refused(sut->run_in_air("scan-0001", "ada"));
  refused(sut->choose_process("scan-0001", "rough", "ada"));
}

/// A yes that would come to nothing is none: it starts neither light nor arm nor the next scan.
TEST(OperatorControlTeach, AYesThatTheGateWouldRefuseIsRefusedWithItsReasonAndChangesNothing) {
  open(true);
  memory::Scan row;
  row.name = "scan-0001";
  row.time = 1;
  row.verdict = "ok";
  row.decision = "held";
  SUCCEEDS(sut->memory().put_scan(row, memory::LogRow{}));
  const auto say = [&](api::Decision::Kind kind) {
    return sut->decide({.kind = kind, .scan = "scan-0001", .who = "ada", .why = {}, .door = "web"});
  };
  const auto refused_for = [&](const char* reason) {
    for (const auto kind : {api::Decision::Kind::Accept, api::Decision::Kind::Send}) {
      const Result<void> word = say(kind);
      refused(word);
      STRCMP_CONTAINS(reason, to_line(word.error()).c_str());
    }
    const api::Json held = sut->state()["held"];
    CHECK_FALSE(held["sendable"].get<bool>());
    STRCMP_CONTAINS(reason, held["reason"].get<std::string>().c_str());
    CHECK(!held["next_step"].get<std::string>().empty());
    CHECK(!sut->next_command());
    STRCMP_EQUAL("held", (*sut->memory().scan("scan-0001"))->decision.c_str());
  };
  test::hold_worked(*sut, {.scan = "scan-0001", .waits = Waits::ForWord, .fresh_s = -5});
  refused_for("too old");
  test::hold_worked(*sut, {.scan = "scan-0001", .waits = Waits::ForWord, .fresh_s = 0});
  refused_for("too old");
  test::hold_worked(*sut, {.scan = "scan-0001", .waits = Waits::ForPath});
  refused_for("no checked path");
  test::hold_worked(*sut, {.scan = "scan-0001", .waits = Waits::ForModel});
  refused_for("model");
  // What the gate would say counts whatever the age.
  test::hold_worked(
      *sut, {.scan = "scan-0001",
             .waits = Waits::ForWord,
             .fresh_s = 100,
             .not_sendable = report::ToldRefusal{
                 .reason_code = "messages_lost", .reason = "messages lost: 3 (0)", .next_step = "again"}});
  refused_for("messages lost");
  STRCMP_EQUAL("messages_lost", sut->state()["held"]["reason_code"].get<std::string>().c_str());
  // One that somebody vouched for has no age.
  test::hold_worked(*sut, {.scan = "scan-0001", .waits = Waits::ForWord});
  CHECK(sut->state()["held"]["sendable"].get<bool>());
  test::hold_worked(*sut, {.scan = "scan-0001", .waits = Waits::ForWord, .fresh_s = 100});
  SUCCEEDS(say(api::Decision::Kind::Accept));
  CHECK(next() == OperatorCommand::Kind::Send);
}

TEST(OperatorControlTeach, StateTellsTheProcessOfTheScanAndThenOfTheNextOneAndWhoseWordItIs) {
  open(true);
  sut->show_next({.name = "rough", .by = {}});
  STRCMP_EQUAL("rough", sut->state()["process"].get<std::string>().c_str());
  CHECK(sut->state()["process_by"].is_null());
  sut->show_model("boot", 1, {.name = "cement", .by = "ada"});
  STRCMP_EQUAL("cement", sut->state()["process"].get<std::string>().c_str());
  STRCMP_EQUAL("ada", sut->state()["process_by"].get<std::string>().c_str());
  // Where its model decides nobody knows before the shoe is seen.
  sut->show_next({});
  CHECK(sut->state()["process"].is_null());
}

TEST(OperatorControlTeach, StateTellsWhoseShoeItIs) {
  open(true);
  for (const char* name : {"part", "foot", "size"}) CHECK_TEXT(sut->state()[name].is_null(), name);
  sut->show_shoe({.part = "A-17", .foot = "left", .size = "EU 42"});
  STRCMP_EQUAL("A-17", sut->state()["part"].get<std::string>().c_str());
  STRCMP_EQUAL("left", sut->state()["foot"].get<std::string>().c_str());
  STRCMP_EQUAL("EU 42", sut->state()["size"].get<std::string>().c_str());
  sut->show_shoe({});
  CHECK(sut->state()["part"].is_null());
}

TEST(OperatorControlTeach, StateSaysWhatWaitsForWhatAndHowLongItIsFresh) {
  open(true);
  CHECK(sut->state()["held"].is_null());
  test::hold_worked(*sut, {.scan = "scan-0001", .waits = Waits::ForWord, .fresh_s = 100});
  api::Json held = sut->state()["held"];
  STRCMP_EQUAL("scan-0001", held["scan"].get<std::string>().c_str());
  STRCMP_EQUAL("word", held["waits_for"].get<std::string>().c_str());
  CHECK(held["fresh_s"].get<double>() <= 100);
  // Of a scan that grew too old before it waited.
  test::hold_worked(*sut, {.scan = "scan-0001", .waits = Waits::ForWord, .fresh_s = -5});
  DOUBLES_EQUAL(0, sut->state()["held"]["fresh_s"].get<double>(), 0);
  test::hold_worked(*sut, {.scan = "scan-0001", .waits = Waits::ForPath});
  held = sut->state()["held"];
  STRCMP_EQUAL("path", held["waits_for"].get<std::string>().c_str());
  CHECK(held["fresh_s"].is_null());
  sut->enter(CellEvent::Reject);
  CHECK(sut->state()["held"].is_null());
}

}  // namespace biteline::service
