// SPDX-License-Identifier: MIT
#include "host/records/memory/memory.hpp"

#include <CppUTest/TestHarness.h>
#include <sys/stat.h>

#include <algorithm>
#include <fstream>
#include <tuple>

#include "host/records/memory/factory_day.hpp"
#include "host/records/memory/history.hpp"
#include "host/records/memory/outbox.hpp"
#include "host/records/memory/schema.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::memory {
namespace {

LogRow by_service(const std::string& action) {
  LogRow row;
  row.who = "service";
  row.action = action;
  return row;
}

Scan scan_named(const std::string& name, UnixMs time, const std::string& verdict = "ok") {
  Scan scan;
  scan.name = name;
  scan.time = time;
  scan.verdict = verdict;
  return scan;
}

}  // namespace

TEST_GROUP(Memory) {
  test::TemporaryFolder folder;
  std::filesystem::path file{folder.path() / k_memory_file};

  Memory opened() {
    auto memory = Memory::open(file);
    SUCCEEDS(memory);
    return std::move(*memory);
  }
};

TEST(Memory, ScanComesBackWithAllThatWasKnown) {
  Memory memory = opened();
  Scan scan = scan_named("scan-0001", 1'700'000'000'123);
  scan.model = "runner";
  scan.model_probability = 0.97;
  scan.part = "A-17";
  scan.foot = "left";
  scan.size = "EU 42";
  scan.length_mm = 640.5;
  scan.confidence = 0.99;
  scan.weak_stretches = 2;
  scan.operator_name = "ana";
  scan.decision = "accepted";
  scan.decided_by = "ana";
  scan.followed = false;
  scan.why = "looked";
  scan.decided_at = 1'700'000'001'000;
  scan.details = "{\"a\":1}";
  scan.reason = "none";
  scan.work = {.verdict = "faulty",
               .reworked = true,
               .missing_mm = 3.5,
               .narrow = 1,
               .wide = 2,
               .beside = 3,
               .doubled = 4};
  SUCCEEDS(memory.put_scan(scan, by_service("result")));
  const auto back = memory.scan("scan-0001");
  SUCCEEDS(back);
  CHECK(back->has_value());
  STRCMP_EQUAL("runner", (*back)->model.c_str());
  DOUBLES_EQUAL(0.97, *(*back)->model_probability, 0);
  STRCMP_EQUAL("A-17", (*back)->part.c_str());
  STRCMP_EQUAL("left", (*back)->foot.c_str());
  STRCMP_EQUAL("EU 42", (*back)->size.c_str());
  DOUBLES_EQUAL(640.5, *(*back)->length_mm, 0);
  CHECK(!(*back)->u95_mm);
  CHECK((*back)->followed == false);
  STRCMP_EQUAL("looked", (*back)->why.c_str());
  LONGS_EQUAL(2, (*back)->weak_stretches);
  STRCMP_EQUAL("ana", (*back)->decided_by.c_str());
  CHECK((*back)->work == scan.work);
  CHECK(*(*back)->decided_at == 1'700'000'001'000);
  STRCMP_EQUAL("{\"a\":1}", (*back)->details.c_str());
  CHECK(!memory.scan("scan-0002")->has_value());
}

TEST(Memory, ListIsNewestFirstFilteredAndPaged) {
  Memory memory = opened();
  for (int i = 1; i <= 25; ++i) {
    Scan scan = scan_named("scan-" + std::to_string(i), i * 1000, i % 5 == 0 ? "refused" : "ok");
    scan.model = i % 2 == 0 ? "even" : "odd";
    SUCCEEDS(memory.put_scan(scan, by_service("result")));
  }
  ScanFilter filter;
  filter.limit = 10;
  std::vector<std::string> names;
  for (int pages = 0; pages < 3; ++pages) {
    const auto page = memory.scans(filter);
    SUCCEEDS(page);
    for (const Scan& scan : page->scans) names.push_back(scan.name);
    filter.before_id = page->next_id;
  }
  LONGS_EQUAL(0, filter.before_id);
  LONGS_EQUAL(25, names.size());
  STRCMP_EQUAL("scan-25", names.front().c_str());
  STRCMP_EQUAL("scan-1", names.back().c_str());

  ScanFilter narrow;
  narrow.from = 10'000;
  narrow.to = 21'000;
  narrow.model = "even";
  narrow.verdict = "refused";
  const auto page = memory.scans(narrow);
  SUCCEEDS(page);
  LONGS_EQUAL(2, page->scans.size());  // 10 and 20
}

TEST(Memory, ResultAndEventAreOneTransaction) {
  Memory memory = opened();
  SUCCEEDS(memory.put_scan(scan_named("scan-0001", 1), by_service("result")));
  Scan broken = scan_named("scan-0002", 2);
  // A log that takes nothing: the scan's row must not stay without its event.
  {
    auto other = Database::open(file, Database::Access::ReadWrite);
    SUCCEEDS(other);
    SUCCEEDS(other->execute("CREATE TRIGGER no BEFORE INSERT ON log BEGIN SELECT RAISE(ABORT, 'no'); END"));
  }
  CHECK(!memory.put_scan(broken, by_service("result")));
  CHECK(!memory.scan("scan-0002")->has_value());
  LONGS_EQUAL(1, memory.log_rows(0, 10)->size());
}

TEST(Memory, LogIsAppendOnly) {
  Memory memory = opened();
  SUCCEEDS(memory.log(by_service("start")));
  auto other = Database::open(file, Database::Access::ReadWrite);
  SUCCEEDS(other);
  FAILS_NAMING(Errc::BadValue, "append-only", other->execute("DELETE FROM log"));
  FAILS_NAMING(Errc::BadValue, "append-only", other->execute("UPDATE log SET who = 'nobody'"));
  LONGS_EQUAL(1, memory.log_rows(0, 10)->size());
}

TEST(Memory, RetentionTakesTheOldestAndNeverWhatIsMarked) {
  Memory memory = opened();
  for (int i = 1; i <= 6; ++i) {
    const std::string name = "scan-000" + std::to_string(i);
    SUCCEEDS(memory.put_scan(scan_named(name, i * 1000), by_service("result")));
    folder.write(name + "/cloud.ply", std::string(1000, 'x'));
  }
  SUCCEEDS(memory.mark("scan-0001", true, by_service("mark")));
  Retention by_age;
  by_age.oldest = 4000;
  const auto old = memory.folders_to_go(by_age, folder.path());
  SUCCEEDS(old);
  CHECK((*old == std::vector<std::string>{"scan-0002", "scan-0003"}));
  Retention by_space;
  by_space.most_bytes = 2500;
  const auto much = memory.folders_to_go(by_space, folder.path());
  SUCCEEDS(much);
  CHECK((*much == std::vector<std::string>{"scan-0002", "scan-0003", "scan-0004", "scan-0005"}));
  SUCCEEDS(memory.forget_folder("scan-0002", by_service("retention")));
  CHECK(memory.scan("scan-0002")->has_value());  // the row stays
  CHECK((*memory.folders_to_go(by_age, folder.path()) == std::vector<std::string>{"scan-0003"}));
  // A mark outlives a result that is worked out again.
  SUCCEEDS(memory.put_scan(scan_named("scan-0001", 1000), by_service("again")));
  CHECK((*memory.scan("scan-0001"))->marked);
}

TEST(Memory, TrendsAreInBucketsWithReasonsByCount) {
  Memory memory = opened();
  for (int i = 0; i < 6; ++i) {
    Scan scan = scan_named("scan-" + std::to_string(i), 20'000 * k_day_ms + (i / 3) * k_day_ms + i,
                           i == 5   ? "refused"
                           : i == 0 ? "amber"
                           : i == 4 ? "review"
                                    : "ok");
    scan.length_mm = 600 + i;
    scan.cycle_s = i * i;
    if (i == 5) scan.reason_code = "no_crease";
    SUCCEEDS(memory.put_scan(scan, by_service("result")));
  }
  const auto trends = memory.trends({}, FactoryDay{}, Span::Day);
  SUCCEEDS(trends);
  LONGS_EQUAL(2, trends->buckets.size());
  CHECK(trends->buckets[0].begin == 20'000 * k_day_ms);
  LONGS_EQUAL(3, trends->buckets[0].scans);
  LONGS_EQUAL(2, trends->buckets[0].ok);
  LONGS_EQUAL(1, trends->buckets[0].amber);
  DOUBLES_EQUAL(601, *trends->buckets[0].mean_length_mm, 1e-9);
  DOUBLES_EQUAL(1, *trends->buckets[0].median_cycle_s, 1e-9);
  CHECK(!trends->buckets[0].median_u95_mm);
  LONGS_EQUAL(1, trends->buckets[1].refused);
  LONGS_EQUAL(1, trends->buckets[1].review);
  LONGS_EQUAL(1, trends->reasons.size());
  STRCMP_EQUAL("no_crease", trends->reasons[0].reason_code.c_str());
  LONGS_EQUAL(0, trends->stopped);
  LONGS_EQUAL(1, memory.trends({}, FactoryDay{}, Span::Week)->buckets.size());
  ScanFilter second;
  second.from = 20'001 * k_day_ms;
  LONGS_EQUAL(1, memory.trends(second, FactoryDay{}, Span::Day)->buckets.size());
}

TEST(Memory, PlacesAreSummedByModelAndTime) {
  Memory memory = opened();
  for (int i = 1; i <= 3; ++i) {
    Scan scan = scan_named("scan-" + std::to_string(i), i * 1000);
    scan.model = "runner";
    Places places{};
    places.fill(0.1F);
    places[7] = static_cast<float>(i);
    SUCCEEDS(memory.put_scan(scan, by_service("result"), places));
  }
  const auto sums = memory.place_sums("runner", 2000, {});
  SUCCEEDS(sums);
  LONGS_EQUAL(2, sums->scans);
  DOUBLES_EQUAL(5, sums->sum_mm[7], 1e-9);
  DOUBLES_EQUAL(13, sums->sum_mm2[7], 1e-9);
  LONGS_EQUAL(0, memory.place_sums("other", {}, {})->scans);
}

TEST(Memory, UserWithNewPasswordLosesSessions) {
  Memory memory = opened();
  SUCCEEDS(memory.put_user({.name = "ana", .role = "operator", .password_hash = "h", .created = 1},
                           by_service("add user")));
  SUCCEEDS(
      memory.put_session({.token_hash = "t", .user = "ana", .role = "operator", .created = 1, .expires = 9},
                         by_service("login")));
  CHECK(memory.session("t")->has_value());
  SUCCEEDS(memory.put_user({.name = "ana", .role = "operator", .password_hash = "i", .created = 1},
                           by_service("password")));
  CHECK(!memory.session("t")->has_value());
  FAILS_NAMING(Errc::FileNotFound, "bob", memory.remove_user("bob", by_service("remove")));
  FAILS_NAMING(
      Errc::BadValue, "CHECK",
      memory.put_user({.name = "eve", .role = "king", .password_hash = "", .created = 1}, by_service("add")));
}

TEST(Memory, NewerSchemaIsRefusedAndOlderRaised) {
  { Memory memory = opened(); }
  {
    auto database = Database::open(file, Database::Access::ReadWrite);
    SUCCEEDS(database->execute("PRAGMA user_version = 99"));
  }
  FAILS_NAMING(Errc::NotSupported, "newer program", Memory::open(file));
  FAILS_NAMING(Errc::NotSupported, "newer program", Memory::open_to_read(file));
  // Of before the first step.
  const std::filesystem::path old = folder.path() / "old.sqlite";
  {
    auto database = Database::open(old, Database::Access::ReadWrite);
    SUCCEEDS(database->execute("CREATE TABLE unrelated (x)"));
  }
  FAILS_NAMING(Errc::NotSupported, "start biteline-host", Memory::open_to_read(old));
  SUCCEEDS(Memory::open(old));
  SUCCEEDS(Memory::open_to_read(old));
}

TEST(Memory, OutboxHasEveryChangeOfAShoeInOrderAndTheShoeAsItIsNow) {
  Memory memory = opened();
  SUCCEEDS(memory.put_scan(scan_named("scan-0001", 1000), by_service("result"), Places{}));
  SUCCEEDS(memory.put_scan(scan_named("scan-0002", 2000), by_service("result")));
  Scan again = scan_named("scan-0001", 1000);
  again.decision = "accepted";
  SUCCEEDS(memory.put_scan(again, by_service("accepted")));
  auto outbox = Outbox::open(file);
  SUCCEEDS(outbox);
  const auto all = outbox->after(0, 100);
  SUCCEEDS(all);
  LONGS_EQUAL(16, all->book.size());
  LONGS_EQUAL(3, all->waiting);
  std::int64_t before = 0;
  for (const OutboxRow& row : all->rows) {
    CHECK(row.seq > row.after);
    CHECK(row.after == before);
    before = row.seq;
  }
  STRCMP_EQUAL("scan-0001", all->rows[0].scan.name.c_str());
  STRCMP_EQUAL("accepted", all->rows[0].scan.decision.c_str());
  CHECK(all->rows[0].places.has_value());
  CHECK(!all->rows[1].places.has_value());
  const auto rest = outbox->after(all->rows[0].seq, 1);
  SUCCEEDS(rest);
  LONGS_EQUAL(2, rest->waiting);
  LONGS_EQUAL(1, rest->rows.size());
  CHECK(rest->rows[0].after == all->rows[0].seq);
  CHECK(rest->book == all->book);
  LONGS_EQUAL(0, outbox->after(1'000'000, 5)->rows.size());
}

TEST(Memory, RowThatIsNotKeptIsNotInTheOutboxEither) {
  Memory memory = opened();
  SUCCEEDS(memory.put_scan(scan_named("scan-0001", 1000), by_service("result")));
  {
    // What fails last fails all of it: the log is part of the transaction.
    auto database = Database::open(file, Database::Access::ReadWrite);
    SUCCEEDS(database->execute(
        "CREATE TRIGGER no_log BEFORE INSERT ON log BEGIN SELECT RAISE(ABORT, 'no log'); END"));
  }
  CHECK(!memory.put_scan(scan_named("scan-0002", 2000), by_service("result")));
  auto outbox = Outbox::open(file);
  SUCCEEDS(outbox);
  LONGS_EQUAL(1, outbox->after(0, 100)->rows.size());
  LONGS_EQUAL(1, memory.scans({})->scans.size());
}

TEST(Memory, ShoesOfBeforeTheOutboxAreInItOnce) {
  {
    Memory memory = opened();
    for (const char* name : {"scan-0001", "scan-0002"})
      SUCCEEDS(memory.put_scan(scan_named(name, 1000), by_service("result")));
    // As the first version left it.
    auto database = Database::open(file, Database::Access::ReadWrite);
    SUCCEEDS(database->execute(
        "DROP INDEX scans_time; DROP INDEX scans_model_time; ALTER TABLE scans DROP COLUMN follows; CREATE "
        "INDEX scans_time ON scans (time); CREATE INDEX scans_model_time ON scans (model); "
        "DROP TABLE outbox; DROP TABLE scan_evidence; DELETE FROM settings WHERE key = "
        "'outbox'; DROP INDEX scans_part; ALTER TABLE scans DROP COLUMN part; ALTER TABLE "
        "scans DROP COLUMN foot; ALTER TABLE scans DROP COLUMN size; ALTER TABLE scans DROP COLUMN "
        "tip_bound_mm; DROP TABLE teaching_scans; DROP TABLE teaching_deeds; DROP TABLE teachings; DROP "
        "INDEX scans_held; ALTER TABLE log DROP COLUMN link; ALTER TABLE scans DROP COLUMN work; ALTER TABLE "
        "scans DROP COLUMN work_reworked; "
        "ALTER TABLE scans DROP COLUMN work_missing_mm; ALTER TABLE scans DROP COLUMN work_narrow; ALTER "
        "TABLE scans DROP COLUMN work_wide; ALTER TABLE scans DROP COLUMN work_beside; ALTER TABLE scans "
        "DROP COLUMN work_doubled; PRAGMA user_version = 1"));
  }
  CHECK(!Outbox::open(file));
  Memory memory = opened();
  auto outbox = Outbox::open(file);
  SUCCEEDS(outbox);
  const auto all = outbox->after(0, 100);
  LONGS_EQUAL(2, all->rows.size());
  STRCMP_EQUAL("scan-0002", all->rows[1].scan.name.c_str());
  // Nor had anybody said whose shoes they were.
  CHECK(all->rows[1].scan.part.empty() && all->rows[1].scan.foot.empty() && all->rows[1].scan.size.empty());
}

TEST(Memory, AShoeIsFoundByItsPartNumberOrTheBeginningOfIt) {
  Memory memory = opened();
  int number = 0;
  for (const char* part : {"A-17", "A-171", "a-17", "", "A-17*", "A-1", "A-18"}) {
    ++number;
    Scan scan = scan_named("scan-" + std::to_string(number), number);
    scan.part = part;
    SUCCEEDS(memory.put_scan(scan, by_service("result")));
  }
  const auto found = [&](const std::string& part) {
    ScanFilter filter;
    filter.part = part;
    const auto page = memory.scans(filter);
    SUCCEEDS(page);
    std::string names;
    for (const Scan& scan : page->scans) names += scan.part + " ";
    return names;
  };
  STRCMP_EQUAL("A-17 ", found("A-17").c_str());
  STRCMP_EQUAL("A-17* A-171 A-17 ", found("A-17*").c_str());
  STRCMP_EQUAL("A-18 A-1 A-17* A-171 A-17 ", found("A-1*").c_str());
  STRCMP_EQUAL("", found("B*").c_str());
  // All that have one, and all.
  LONGS_EQUAL(6, std::ranges::count(found("*"), ' '));
  LONGS_EQUAL(7, std::ranges::count(found(""), ' '));
}

TEST(Memory, OfAPartNumberTheNewestOtherScanThatWasSentIsTold) {
  Memory memory = opened();
  for (const auto& [name, part, sent] :
       {std::tuple{"scan-0001", "A-17", true}, std::tuple{"scan-0002", "A-17", true},
        std::tuple{"scan-0003", "A-17", false}, std::tuple{"scan-0004", "A-18", true},
        std::tuple{"scan-0005", "", true}}) {
    Scan scan = scan_named(name, 1000);
    scan.part = part;
    scan.sent = sent;
    SUCCEEDS(memory.put_scan(scan, by_service("result")));
  }
  const auto before = [&](const char* part, const char* scan) {
    const auto found = memory.sent_before(part, scan);
    SUCCEEDS(found);
    return *found ? (*found)->name : std::string{};
  };
  STRCMP_EQUAL("scan-0002", before("A-17", "scan-0003").c_str());
  STRCMP_EQUAL("scan-0001", before("A-17", "scan-0002").c_str());
  STRCMP_EQUAL("", before("A-18", "scan-0004").c_str());
  STRCMP_EQUAL("", before("", "scan-0001").c_str());
}

TEST(Memory, FileIsItsOwnersAloneAndOthersKindIsRefused) {
  { Memory memory = opened(); }
  struct stat status {};
  ::stat(file.c_str(), &status);
  LONGS_EQUAL(0600, status.st_mode & 0777);
  FAILS_NAMING(Errc::FileNotFound, "no memory", Memory::open_to_read(folder.path() / "none.sqlite"));
  folder.write("text.sqlite", "this is no database, whatever its name says, and it is long enough to be one");
  FAILS_NAMING(Errc::BadFormat, "text.sqlite", Memory::open(folder.path() / "text.sqlite"));
}

TEST(Memory, CopyIsWholeWhileTheMemoryIsOpen) {
  Memory memory = opened();
  SUCCEEDS(memory.put_scan(scan_named("scan-0001", 1), by_service("result")));
  SUCCEEDS(memory.copy_to(folder.path() / "copy.sqlite"));
  auto copy = Memory::open_to_read(folder.path() / "copy.sqlite");
  SUCCEEDS(copy);
  CHECK(copy->scan("scan-0001")->has_value());
}

TEST(Memory, TimesAreReadAndWrittenAsIso) {
  STRCMP_EQUAL("2026-11-20T21:04:05.123Z", to_iso(*from_iso("2026-11-20T21:04:05.123Z")).c_str());
  STRCMP_EQUAL("2026-11-20T00:00:00.000Z", to_iso(*from_iso("2026-11-20")).c_str());
  for (const char* bad :
       {"", "today", "2026-13-01", "2026-11-20T25:00:00", "2026-11-20x", "2026-11-20T21:04:05.123Zx"})
    CHECK_TEXT(!from_iso(bad), bad);
}

TEST(Memory, LogIsInTheOrderOfItsTimesAndPagesMissNoRow) {
  Memory memory = opened();
  // Rows of a clock that was put back, and of results that were taken up later.
  const UnixMs times[] = {5000, 6000, 1000, 1000, 9000, 3000, 6000, 2000};
  for (const UnixMs time : times)
    SUCCEEDS(memory.log({.id = 0,
                         .time = time,
                         .who = "a",
                         .door = {},
                         .action = "b",
                         .subject = {},
                         .before = {},
                         .after = {}}));
  std::vector<LogRow> all;
  for (std::int64_t cursor = 0;;) {
    const auto page = memory.log_rows(cursor, 3);
    SUCCEEDS(page);
    all.insert(all.end(), page->begin(), page->end());
    if (page->size() < 3) break;
    cursor = page->back().id;
  }
  LONGS_EQUAL(std::size(times), all.size());
  for (std::size_t i = 1; i < all.size(); ++i)
    CHECK(all[i - 1].time > all[i].time || (all[i - 1].time == all[i].time && all[i - 1].id > all[i].id));
  LONGS_EQUAL(3, memory.log_rows(0, 10, 5000, 9000)->size());
}

/// It says nothing of a shoe; a stop while the arm follows does, as the line was found.
TEST(Memory, AShoeCountsOnceHoweverManyScansItHas) {
  Memory memory = opened();
  Scan first = scan_named("scan-0001", 20'000 * k_day_ms, "ok");
  Scan rework = scan_named("scan-0002", 20'000 * k_day_ms + 1, "ok");
  rework.follows = first.name;
  Scan next = scan_named("scan-0003", 20'000 * k_day_ms + 2, "refused");
  next.follows = rework.name;
  next.reason_code = "out_of_reach";
  for (const Scan& scan : {first, rework, next}) SUCCEEDS(memory.put_scan(scan, by_service("result")));
  STRCMP_EQUAL("scan-0002", (*memory.scan("scan-0003"))->follows.c_str());
  const auto trends = memory.trends({}, FactoryDay{}, Span::Day);
  SUCCEEDS(trends);
  LONGS_EQUAL(1, trends->buckets.size());
  LONGS_EQUAL(1, trends->buckets[0].scans);
  LONGS_EQUAL(1, trends->buckets[0].ok);
  // Why a process after the first came to nothing is told all the same.
  LONGS_EQUAL(1, trends->reasons.size());
  LONGS_EQUAL(3, memory.scans({})->scans.size());
}

TEST(Memory, TrendsLeaveOutWhatAPersonStoppedOnItsWay) {
  Memory memory = opened();
  Scan stopped = scan_named("scan-0001", 20'000 * k_day_ms, "refused");
  stopped.reason_code = k_stopped_by_a_person;
  Scan followed = scan_named("scan-0002", 20'000 * k_day_ms + 1, "ok");
  followed.reason_code = k_stopped_by_a_person;
  Scan refused = scan_named("scan-0003", 20'000 * k_day_ms + 2, "refused");
  refused.reason_code = "no_crease";
  for (const Scan& scan : {stopped, followed, refused}) SUCCEEDS(memory.put_scan(scan, by_service("result")));
  const auto trends = memory.trends({}, FactoryDay{}, Span::Day);
  SUCCEEDS(trends);
  LONGS_EQUAL(1, trends->buckets.size());
  LONGS_EQUAL(2, trends->buckets[0].scans);
  LONGS_EQUAL(1, trends->buckets[0].refused);
  LONGS_EQUAL(2, trends->reasons.size());
  for (const ReasonCount& reason : trends->reasons) LONGS_EQUAL(1, reason.scans);
  // It is counted as what it was.
  LONGS_EQUAL(1, trends->stopped);
  const auto json = to_json(*trends);
  LONGS_EQUAL(2, json["ended_by"]["person"].get<int>());
  LONGS_EQUAL(0, json["ended_by"]["machine"].get<int>());
  LONGS_EQUAL(1, json["ended_by"]["shoe"].get<int>());
  for (const auto& reason : json["reasons"])
    STRCMP_EQUAL(reason["reason_code"] == "no_crease" ? "shoe" : "person",
                 reason["ended_by"].get<std::string>().c_str());
  // Its row stays in the list.
  LONGS_EQUAL(3, memory.scans({})->scans.size());
}

TEST(Memory, EvidenceOfAScanIsKeptWithItsRowAndTheNewestCounts) {
  Memory memory = opened();
  CHECK(!memory.put_evidence("scan-0001", {.line = "ab"}));
  SUCCEEDS(memory.put_scan(scan_named("scan-0001", 1), by_service("result")));
  CHECK(*memory.evidence("scan-0001") == std::nullopt);
  SUCCEEDS(memory.put_evidence("scan-0001", {.line = "ab", .cloud = "cd", .process = "", .report = "ef"}));
  const Evidence newest{.line = "gh", .cloud = "cd", .process = "ij", .report = "kl"};
  SUCCEEDS(memory.put_evidence("scan-0001", newest));
  // A row that is written again keeps it.
  SUCCEEDS(memory.put_scan(scan_named("scan-0001", 2), by_service("result")));
  CHECK(*memory.evidence("scan-0001") == newest);
}

}  // namespace biteline::memory
