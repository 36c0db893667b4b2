// SPDX-License-Identifier: MIT
// Teachings: which steps follow of the facts, and that the facts come back.
#include "host/records/memory/teaching.hpp"

#include <CppUTest/TestHarness.h>

#include "host/records/memory/memory.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::memory {
namespace {

/// Everything done but the model.
Teaching run_in_air_to_its_end() {
  Teaching teaching;
  teaching.begun = 1'700'000'000'000;
  teaching.begun_by = "ada";
  teaching.work = {.scan = "scan-0007", .line_version = 2, .process_sha256 = "a1"};
  teaching.scans_before = {"scan-0005", "scan-0006"};
  teaching.verdict = "amber";
  teaching.has_path = true;
  teaching.process = "cement";
  teaching.process_by = "ada";
  teaching.dry_run = Teaching::Deed{
      .work = teaching.work, .who = "eve", .time = 1'700'000'001'000, .outcome = {}, .mark = {}};
  teaching.air = Teaching::Deed{
      .work = teaching.work, .who = "ada", .time = 1'700'000'002'000, .outcome = "followed", .mark = "17"};
  teaching.followed = teaching.air;
  return teaching;
}

/// As "done done now(no_path) open(not_seen) ...".
std::string told(const Teaching& teaching) {
  std::string words;
  for (const StepState& step : steps_of(teaching)) {
    words += step.is == StepState::Is::Done ? "done" : step.is == StepState::Is::Now ? "now" : "open";
    if (!step.why.empty()) words += "(" + std::string{step.why} + ")";
    words += " ";
  }
  words.pop_back();
  return words;
}

}  // namespace

TEST_GROUP(TeachSteps){};

TEST(TeachSteps, ANewOneWaitsForItsScanAndNothingElseIsDone) {
  STRCMP_EQUAL("now(no_scan) open(no_line) open(not_chosen) open(not_seen) open(not_run) open(not_saved)",
               told({}).c_str());
  CHECK(step_of({}) == TeachStep::Scan);
}

TEST(TeachSteps, EachFactMovesTheStepThatIsNextOn) {
  Teaching teaching;
  teaching.work = {.scan = "scan-0001", .line_version = 0, .process_sha256 = "a1"};
  teaching.verdict = "review";
  STRCMP_CONTAINS("done now(to_settle) open(not_chosen)", told(teaching).c_str());
  teaching.verdict = "refused";
  STRCMP_CONTAINS("done now(no_line)", told(teaching).c_str());
  teaching.verdict = "ok";
  // The model's own process, or the service's: nobody has chosen it.
  teaching.has_path = true;
  STRCMP_CONTAINS("done done now(not_chosen)", told(teaching).c_str());
  teaching.process_by = "ada";
  teaching.has_path = false;
  STRCMP_CONTAINS("done done now(no_path)", told(teaching).c_str());
  teaching.has_path = true;
  STRCMP_CONTAINS("done done done now(not_seen) open(not_run)", told(teaching).c_str());
  teaching.dry_run =
      Teaching::Deed{.work = teaching.work, .who = "ada", .time = 1, .outcome = {}, .mark = {}};
  STRCMP_CONTAINS("done done done done now(not_run)", told(teaching).c_str());
  teaching.air = teaching.dry_run;
  for (const auto& [outcome, why] : {std::pair{"begun", "now(running)"}, std::pair{"refused", "now(refused)"},
                                     std::pair{"stopped", "now(stopped)"}}) {
    teaching.air->outcome = outcome;
    STRCMP_CONTAINS(why, told(teaching).c_str());
  }
  teaching.followed = teaching.air;
  STRCMP_EQUAL("done done done done done now(not_saved)", told(teaching).c_str());
  teaching.model = "boot";
  teaching.ended = 5;
  STRCMP_EQUAL("done done done done done done", told(teaching).c_str());
  CHECK(!step_of(teaching));
}

TEST(TeachSteps, WhatTheArmRanNeedsNoLookBeside) {
  Teaching teaching = run_in_air_to_its_end();
  teaching.dry_run.reset();
  STRCMP_EQUAL("done done done done done now(not_saved)", told(teaching).c_str());
}

TEST(TeachSteps, AnotherLineProcessOrScanOpensWhatWasDoneWithTheOneBefore) {
  const auto change = [](auto&& how) {
    Teaching teaching = run_in_air_to_its_end();
    how(teaching.work);
    return told(teaching);
  };
  STRCMP_EQUAL("done done done now(line_changed) open(line_changed) open(not_saved)",
               change([](TaughtWork& work) { work.line_version = 3; }).c_str());
  STRCMP_EQUAL("done done done now(process_changed) open(process_changed) open(not_saved)",
               change([](TaughtWork& work) { work.process_sha256 = "b2"; }).c_str());
  STRCMP_EQUAL("done done done now(scanned_again) open(scanned_again) open(not_saved)",
               change([](TaughtWork& work) { work.scan = "scan-0008"; }).c_str());
  // Back to what was run: nothing was lost.
  STRCMP_EQUAL("done done done done done now(not_saved)", change([](TaughtWork&) {}).c_str());
}

TEST(TeachSteps, ALaterRunThatCameToNothingTakesNothingFromTheOneBefore) {
  Teaching teaching = run_in_air_to_its_end();
  teaching.air->outcome = "refused";
  STRCMP_EQUAL("done done done done done now(not_saved)", told(teaching).c_str());
  // Of the mended line it is the newest that is known.
  teaching.work.line_version = 3;
  teaching.air->work.line_version = 3;
  STRCMP_EQUAL("done done done now(line_changed) open(refused) open(not_saved)", told(teaching).c_str());
}

TEST(TeachSteps, OneThatWasGivenUpHasNoNextStep) {
  Teaching teaching;
  teaching.ended = 1;
  teaching.ended_how = "given_up";
  STRCMP_CONTAINS("open(no_scan) open(no_line)", told(teaching).c_str());
  CHECK(!step_of(teaching));
}

TEST_GROUP(Teachings) {
  test::TemporaryFolder folder;
  std::filesystem::path file{folder.path() / k_memory_file};

  Memory opened() {
    auto memory = Memory::open(file);
    SUCCEEDS(memory);
    return std::move(*memory);
  }
};

TEST(Teachings, OneComesBackWithAllItsFactsAndTheNewestIsFirst) {
  Memory memory = opened();
  Teaching teaching = run_in_air_to_its_end();
  const auto id = memory.put_teaching(teaching);
  SUCCEEDS(id);
  teaching.id = *id;
  CHECK(**memory.teaching(*id) == teaching);
  // A changed one keeps its place; parts that are gone are gone.
  teaching.work.scan = "scan-0009";
  teaching.scans_before = {"scan-0005", "scan-0006", "scan-0007"};
  teaching.dry_run.reset();
  teaching.model = "boot";
  teaching.ended = 1'700'000'009'000;
  teaching.ended_by = "ada";
  teaching.ended_how = "saved";
  CHECK(*memory.put_teaching(teaching) == *id);
  CHECK(**memory.teaching(*id) == teaching);
  const auto second = memory.put_teaching({});
  SUCCEEDS(second);
  const auto all = memory.teachings(0, 10);
  SUCCEEDS(all);
  LONGS_EQUAL(2, all->size());
  CHECK(all->front().id == *second && all->back() == teaching);
  LONGS_EQUAL(1, memory.teachings(*second, 10)->size());
  LONGS_EQUAL(1, memory.teachings(0, 1)->size());
  CHECK(!memory.teaching(99)->has_value());
}

TEST(Teachings, AScanIsFoundInTheOneThatIsOrWasAboutIt) {
  Memory memory = opened();
  Teaching teaching = run_in_air_to_its_end();
  teaching.id = *memory.put_teaching(teaching);
  for (const char* scan : {"scan-0005", "scan-0007"})
    CHECK_TEXT((*memory.teaching_of(scan))->id == teaching.id, scan);
  CHECK(!memory.teaching_of("scan-0008")->has_value());
  for (const char* how : {"given_up", "replaced"}) {
    teaching.ended = 1;
    teaching.ended_how = how;
    SUCCEEDS(memory.put_teaching(teaching));
    CHECK_TEXT(!memory.teaching_of("scan-0007")->has_value(), how);
  }
  teaching.ended_how = "by magic";
  FAILS_NAMING(Errc::BadValue, "CHECK", memory.put_teaching(teaching));
}

TEST(Teachings, WithItsLogLineOrNotAtAll) {
  Memory memory = opened();
  LogRow event;
  event.who = "eve";
  event.action = "look at dry run";
  SUCCEEDS(memory.put_teaching(run_in_air_to_its_end(), event));
  STRCMP_EQUAL("look at dry run", memory.log_rows(0, 1)->front().action.c_str());
  {
    auto database = Database::open(file, Database::Access::ReadWrite);
    SUCCEEDS(database->execute(
        "CREATE TRIGGER no_log BEFORE INSERT ON log BEGIN SELECT RAISE(ABORT, 'no log'); END"));
  }
  CHECK(!memory.put_teaching({}, event));
  LONGS_EQUAL(1, memory.teachings(0, 10)->size());
}

TEST(Teachings, TheNewestScanThatIsHeldSinceATimeIsFound) {
  Memory memory = opened();
  STRCMP_EQUAL("", memory.held_since(0)->c_str());
  int number = 0;
  for (const char* decision : {"held", "held", "rejected", "open"}) {
    ++number;
    Scan scan;
    scan.name = "scan-000" + std::to_string(number);
    scan.time = 100 * number;
    scan.verdict = "ok";
    scan.decision = decision;
    SUCCEEDS(memory.put_scan(scan, {}));
  }
  STRCMP_EQUAL("scan-0002", memory.held_since(0)->c_str());
  STRCMP_EQUAL("scan-0002", memory.held_since(200)->c_str());
  STRCMP_EQUAL("", memory.held_since(201)->c_str());
}

TEST(Teachings, AMemoryOfBeforeThemIsRaisedAndKeepsWhatItHas) {
  {
    Memory memory = opened();
    Scan scan;
    scan.name = "scan-0001";
    scan.time = 100;
    scan.verdict = "ok";
    scan.part = "A-17";
    scan.decision = "held";
    SUCCEEDS(memory.put_scan(scan, {}));
    // As step 5 left it.
    auto database = Database::open(file, Database::Access::ReadWrite);
    SUCCEEDS(database->execute(
        "DROP INDEX scans_time; DROP INDEX scans_model_time; ALTER TABLE scans DROP COLUMN follows; CREATE "
        "INDEX scans_time ON scans (time); CREATE INDEX scans_model_time ON scans (model); "
        "DROP TABLE teaching_scans; DROP TABLE teaching_deeds; DROP TABLE teachings; "
        "DROP INDEX scans_held; ALTER TABLE scans DROP COLUMN tip_bound_mm; ALTER TABLE log DROP COLUMN "
        "link; PRAGMA "
        "user_version = 5; ALTER TABLE scans DROP COLUMN work; ALTER TABLE scans DROP COLUMN work_reworked; "
        "ALTER TABLE scans DROP COLUMN work_missing_mm; ALTER TABLE scans DROP COLUMN work_narrow; ALTER "
        "TABLE scans DROP COLUMN work_wide; ALTER TABLE scans DROP COLUMN work_beside; ALTER TABLE scans "
        "DROP COLUMN work_doubled;"));
  }
  FAILS_NAMING(Errc::NotSupported, "start biteline-host once", Memory::open_to_read(file));
  Memory memory = opened();
  STRCMP_EQUAL("A-17", (*memory.scan("scan-0001"))->part.c_str());
  STRCMP_EQUAL("scan-0001", memory.held_since(0)->c_str());
  LONGS_EQUAL(0, memory.teachings(0, 10)->size());
  SUCCEEDS(memory.put_teaching(run_in_air_to_its_end()));
}

}  // namespace biteline::memory
