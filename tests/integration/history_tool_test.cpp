// SPDX-License-Identifier: MIT
// `biteline history --verify-log` on a memory that somebody wrote into.
#include <CppUTest/TestHarness.h>

#include <fstream>

#include "host/intake/child_process.hpp"
#include "host/records/memory/memory.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/json.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline {

TEST_GROUP(HistoryTool) {
  test::TemporaryFolder folder;
  std::filesystem::path file{folder.path() / memory::k_memory_file}, links{folder.path() / "cell.links"};

  void write(int rows) const {
    auto memory = memory::Memory::open(file);
    SUCCEEDS(memory);
    memory::LogRow row;
    row.who = "ana";
    row.action = "settings";
    for (int i = 0; i < rows; ++i) SUCCEEDS(memory->log(row));
  }
  void attack(const std::string& sql) const {
    auto database = memory::Database::open(file, memory::Database::Access::ReadWrite);
    SUCCEEDS(database);
    SUCCEEDS(database->execute(
        "DROP TRIGGER IF EXISTS log_is_not_changed; DROP TRIGGER IF EXISTS log_is_not_deleted; " + sql));
  }
  struct Said {
    int status{0};
    std::string out, last_error;
  };
  Said verify(std::vector<std::string> more = {}) const {
    more.insert(more.begin(), {"history", folder.path().string(), "--verify-log"});
    auto child = intake::ChildProcess::start({.program = BITELINE_TOOL, .arguments = more});
    SUCCEEDS(child);
    Said said;
    while (const auto line = child->next_line(std::chrono::seconds{30})) said.out += *line + "\n";
    said.status = child->wait(std::chrono::seconds{30}).value_or(-1);
    said.last_error = child->last_words();
    return said;
  }
  int kept() const {
    std::ifstream in(links);
    int lines = 0;
    for (std::string line; std::getline(in, line);) ++lines;
    return lines;
  }
};

TEST(HistoryTool, ALogThatHoldsKeepsItsNewestLink) {
  write(3);
  const Said whole = verify({"--kept-links", links.string()});
  LONGS_EQUAL(0, whole.status);
  STRCMP_CONTAINS("whole: 3 rows", whole.out.c_str());
  LONGS_EQUAL(1, kept());
  write(2);
  STRCMP_CONTAINS("all 1 kept links stand", verify({"--kept-links", links.string()}).out.c_str());
  LONGS_EQUAL(2, kept());
}

TEST(HistoryTool, WhatWasDoneToALogIsToldWithStatusThree) {
  write(5);
  LONGS_EQUAL(0, verify({"--kept-links", links.string()}).status);
  attack("DELETE FROM log WHERE id > 3; UPDATE sqlite_sequence SET seq = 3 WHERE name = 'log'");
  LONGS_EQUAL(0, verify().status);
  const Said cut = verify({"--kept-links", links.string(), "--json"});
  LONGS_EQUAL(3, cut.status);
  STRCMP_EQUAL("log_cut", test::read_json(cut.out).value("reason_code", "").c_str());
  LONGS_EQUAL(1, kept());
  attack("UPDATE log SET who = 'eve' WHERE id = 2");
  const Said changed = verify();
  LONGS_EQUAL(3, changed.status);
  STRCMP_CONTAINS("row 2 (settings", changed.last_error.c_str());
  STRCMP_CONTAINS("not as it was written", changed.last_error.c_str());
}

}  // namespace biteline
