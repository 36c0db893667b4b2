// SPDX-License-Identifier: MIT
#include "host/records/memory/log_chain.hpp"

#include <CppUTest/TestHarness.h>

#include <set>

#include "host/records/memory/memory.hpp"
#include "host/records/memory/schema.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/refusals.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::memory {

namespace {

LogRow started(const std::string& who = "service") {
  LogRow row;
  row.who = who;
  row.action = "start";
  return row;
}

}  // namespace

TEST_GROUP(LogChain) {
  test::TemporaryFolder folder;
  std::filesystem::path file{folder.path() / k_memory_file};

  Memory opened() const {
    auto memory = Memory::open(file);
    SUCCEEDS(memory);
    return std::move(*memory);
  }
  /// Rows 1 to `count`, alternately alone and beside a scan's row.
  void write(int count) const {
    Memory memory = opened();
    for (int i = 1; i <= count; ++i) {
      LogRow row;
      row.time = 1'700'000'000'000 + i;
      row.who = "ana";
      row.door = "page";
      row.action = "settings";
      row.subject = "speed";
      row.before = std::to_string(i);
      row.after = std::to_string(i + 1);
      Scan scan;
      scan.name = "scan-" + std::to_string(i);
      scan.verdict = "ok";
      SUCCEEDS(i % 2 == 0 ? memory.put_scan(scan, row) : memory.log(row));
    }
  }
  /// As somebody who can write the file.
  void attack(const std::string& sql) const {
    auto database = Database::open(file, Database::Access::ReadWrite);
    SUCCEEDS(database);
    SUCCEEDS(database->execute(
        "DROP TRIGGER IF EXISTS log_is_not_changed; DROP TRIGGER IF EXISTS log_is_not_deleted; " + sql));
  }
  LogVerdict verdict(const std::vector<LogLink>& kept = {}) const {
    auto memory = Memory::open_to_read(file);
    SUCCEEDS(memory);
    auto verdict = memory->verify_log(kept);
    SUCCEEDS(verdict);
    return *verdict;
  }
  static std::set<std::int64_t> rows_of(const LogVerdict& verdict) {
    std::set<std::int64_t> rows;
    for (const LogFault& fault : verdict.faults) rows.insert(fault.row);
    return rows;
  }
  using Rows = std::set<std::int64_t>;
};

TEST(LogChain, WhatWasWrittenHolds) {
  write(20);
  const LogVerdict whole = verdict();
  LONGS_EQUAL(20, whole.rows);
  LONGS_EQUAL(1, whole.first_linked);
  LONGS_EQUAL(0, whole.sealed);
  LONGS_EQUAL(0, whole.faults.size());
  LONGS_EQUAL(20, whole.last.row);
  LONGS_EQUAL(64, whole.last.link.size());
}

TEST(LogChain, EachFieldOfEachRowCounts) {
  write(4);
  // A spoilt value is put right again: each attack is alone.
  for (const char* field : {"time", "who", "door", "action", "subject", "before", "after", "link"}) {
    for (int row = 1; row <= 4; ++row) {
      const std::string name{field}, where = " WHERE id = " + std::to_string(row),
                                     other = name == "time" ? "1" : "'another'";
      attack("CREATE TABLE right AS SELECT " + name + " AS value FROM log" + where + "; UPDATE log SET " +
             name + " = " + other + where);
      const LogVerdict changed = verdict();
      CHECK_TEXT(!changed.faults.empty(), field);
      LONGS_EQUAL(row, changed.faults.front().row);
      STRCMP_CONTAINS("not as it was written", changed.faults.front().what.c_str());
      CHECK(changed.faults.front().code == LogRefused::Changed);
      attack("UPDATE log SET " + name + " = (SELECT value FROM right)" + where + "; DROP TABLE right");
    }
  }
  LONGS_EQUAL(0, verdict().faults.size());
}

TEST(LogChain, TextsThatMoveFromFieldToFieldCount) {
  write(3);
  attack("UPDATE log SET who = 'an', door = 'apage' WHERE id = 2");
  CHECK(rows_of(verdict()) == Rows{2});
}

TEST(LogChain, ADroppedRowIsMissed) {
  for (const int row : {2, 3, 9}) {
    std::filesystem::remove(file);
    write(10);
    attack("DELETE FROM log WHERE id = " + std::to_string(row));
    CHECK(rows_of(verdict()) == Rows{row});
  }
  // Closed up behind it, so that no number is missing.
  std::filesystem::remove(file);
  write(10);
  attack("DELETE FROM log WHERE id = 5; UPDATE log SET id = id - 1 WHERE id > 5");
  CHECK_FALSE(verdict().faults.empty());
  LONGS_EQUAL(5, verdict().faults.front().row);
  // The first one.
  std::filesystem::remove(file);
  write(10);
  attack("DELETE FROM log WHERE id = 1");
  LONGS_EQUAL(2, verdict().faults.front().row);
}

TEST(LogChain, SwappedRowsAndOnesPutInAreFound) {
  write(10);
  attack(
      "UPDATE log SET id = 100 WHERE id = 4; UPDATE log SET id = 4 WHERE id = 7; UPDATE log SET id = 7 "
      "WHERE id = 100");
  const Rows swapped = rows_of(verdict());
  CHECK(swapped.contains(4) && swapped.contains(7));
  std::filesystem::remove(file);
  write(10);
  attack(
      "UPDATE log SET id = -id WHERE id > 5; UPDATE log SET id = 1 - id WHERE id < 0; INSERT INTO log SELECT "
      "6, time, 'eve', door, action, subject, before, after, link FROM log WHERE id = 5");
  CHECK(rows_of(verdict()).contains(6));
}

TEST(LogChain, ACutEndIsFoundByTheCountAndByAKeptLink) {
  write(10);
  const std::vector<LogLink> kept{verdict().last};
  attack("DELETE FROM log WHERE id > 7");
  const LogVerdict cut = verdict();
  CHECK(rows_of(cut) == Rows{8});
  CHECK(cut.faults.front().code == LogRefused::Cut);
  STRCMP_CONTAINS("rows 8 to 10 are missing", cut.faults.front().what.c_str());
  // With the count, too: the file alone looks whole.
  attack("UPDATE sqlite_sequence SET seq = 7 WHERE name = 'log'");
  LONGS_EQUAL(0, verdict().faults.size());
  CHECK(rows_of(verdict(kept)) == Rows{10});
  // And written on, to the same length.
  {
    Memory memory = opened();
    for (int i = 0; i < 5; ++i) SUCCEEDS(memory.log(started()));
  }
  LONGS_EQUAL(0, verdict().faults.size());
  STRCMP_CONTAINS("another link was kept", verdict(kept).faults.at(0).what.c_str());
}

TEST(LogChain, AChainThatWasMadeAnewIsFoundByAKeptLink) {
  write(10);
  const std::vector<LogLink> kept{verdict().last};
  // Rows 8 to 10 are written again, by another name, by this very program.
  attack("DELETE FROM log WHERE id > 7; UPDATE sqlite_sequence SET seq = 7 WHERE name = 'log'");
  {
    Memory memory = opened();
    for (int i = 0; i < 3; ++i) SUCCEEDS(memory.log(started("eve")));
  }
  LONGS_EQUAL(0, verdict().faults.size());
  CHECK(rows_of(verdict(kept)) == Rows{10});
}

TEST(LogChain, ALogOfBeforeTheChainIsToldAndSealedByItsFirstLink) {
  write(6);
  attack(
      "DROP INDEX scans_time; DROP INDEX scans_model_time; ALTER TABLE scans DROP COLUMN follows; CREATE "
      "INDEX scans_time ON scans (time); CREATE INDEX scans_model_time ON scans (model); ALTER TABLE log "
      "DROP COLUMN link; PRAGMA user_version = " +
      std::to_string(schema_version() - 2));
  FAILS_NAMING(Errc::NotSupported, "start biteline-host once", Memory::open_to_read(file));
  { Memory memory = opened(); }
  const LogVerdict before = verdict();
  LONGS_EQUAL(0, before.first_linked);
  LONGS_EQUAL(6, before.sealed);
  LONGS_EQUAL(0, before.faults.size());
  CHECK(before.last.link.empty());
  {
    Memory memory = opened();
    for (int i = 0; i < 3; ++i) SUCCEEDS(memory.log(started()));
  }
  const LogVerdict sealed = verdict();
  LONGS_EQUAL(7, sealed.first_linked);
  LONGS_EQUAL(6, sealed.sealed);
  LONGS_EQUAL(0, sealed.faults.size());
  auto database = Database::open(file, Database::Access::ReadWrite);
  SUCCEEDS(database->execute("UPDATE log SET who = 'eve' WHERE id = 3"));
  CHECK(rows_of(verdict()) == Rows{7});
  STRCMP_CONTAINS("it, or a row before it", verdict().faults.front().what.c_str());
}

TEST(LogChain, LinksOfARowAreLostWithTheChain) {
  // Whoever takes the links away makes a log of before the chain of it: a kept link tells.
  write(5);
  const std::vector<LogLink> kept{verdict().last};
  attack("UPDATE log SET link = ''");
  LONGS_EQUAL(0, verdict().first_linked);
  CHECK(rows_of(verdict(kept)) == Rows{5});
  std::filesystem::remove(file);
  write(5);
  attack("UPDATE log SET link = '' WHERE id > 3");
  CHECK((rows_of(verdict()) == Rows{4, 5}));
}

TEST(LogChain, EveryKeptLinkOfARowCounts) {
  write(10);
  const LogLink last = verdict().last;
  const LogLink other{.row = last.row, .link = std::string(64, '0')};
  LONGS_EQUAL(0, verdict({last, last}).faults.size());
  for (const auto& kept : {std::vector{last, other}, std::vector{other, last}}) {
    CHECK(rows_of(verdict(kept)) == Rows{10});
    STRCMP_CONTAINS("another link was kept", verdict(kept).faults.at(0).what.c_str());
  }
}

TEST(LogChain, KeptLinksAreAFileOfLines) {
  write(4);
  const std::filesystem::path links = folder.path() / "links.txt";
  LONGS_EQUAL(0, read_kept_links(links)->size());
  const LogLink first = verdict().last;
  SUCCEEDS(keep_link(links, first));
  SUCCEEDS(keep_link(links, first));
  {
    Memory memory = opened();
    SUCCEEDS(memory.log(started()));
  }
  SUCCEEDS(keep_link(links, verdict().last));
  const auto kept = read_kept_links(links);
  SUCCEEDS(kept);
  CHECK((*kept == std::vector<LogLink>{first, verdict().last}));
  LONGS_EQUAL(0, verdict(*kept).faults.size());
  folder.write("links.txt", "4 abc\n");
  FAILS_NAMING(Errc::BadFormat, "line 1", read_kept_links(links));
  FAILS_NAMING(Errc::FileUnreadable, "no file of kept links", read_kept_links(folder.path()));
}

TEST(LogChain, CodesAreInTheirTable) {
  test::check_refusal_table(LogRefused::Cut);
}

}  // namespace biteline::memory
