// SPDX-License-Identifier: MIT
#include "host/apps/biteline-host/part.hpp"

#include <CppUTest/TestHarness.h>

#include <fstream>

#include "tests/support/errors.hpp"
#include "tests/support/json.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::service {

TEST_GROUP(Part) {
  test::TemporaryFolder folder;

  memory::Memory opened() {
    auto memory = memory::Memory::open(folder.path() / memory::k_memory_file);
    SUCCEEDS(memory);
    return std::move(*memory);
  }
  static memory::Scan sent(const char* name, const char* part, std::optional<bool> followed) {
    memory::Scan scan;
    scan.name = name;
    scan.time = 1'795'000'000'000;
    scan.verdict = "ok";
    scan.part = part;
    scan.sent = true;
    scan.followed = followed;
    return scan;
  }
};

TEST(Part, AServiceThatComesAfterThisOneReadsItBesideTheRecording) {
  STRCMP_EQUAL("", marked_part(folder.path()).c_str());
  SUCCEEDS(mark_part(folder.path(), std::string(64, 'x')));
  STRCMP_EQUAL(std::string(64, 'x').c_str(), marked_part(folder.path()).c_str());
  SUCCEEDS(mark_part(folder.path(), "A-17 /4"));
  STRCMP_EQUAL("A-17 /4", marked_part(folder.path()).c_str());
  for (const std::string& none : {std::string{"\n"}, std::string{"a\tb\n"}, std::string(100, 'x')}) {
    folder.write("scan.part", none);
    STRCMP_EQUAL("", marked_part(folder.path()).c_str());
  }
}

TEST(Part, ReportSaysWhoseShoeItIsAndKeepsTheRest) {
  SUCCEEDS(tell_shoe(folder.path(), {.part = "A-17"}));
  CHECK(!std::filesystem::exists(folder.path() / "report.json"));
  folder.write("report.json", R"({"status":"ok","length_mm":640.5})");
  SUCCEEDS(tell_shoe(folder.path(), {.part = "A-17", .foot = "left", .size = {}}));
  std::ifstream stream{folder.path() / "report.json"};
  const nlohmann::json report = test::read_json(stream);
  STRCMP_EQUAL("A-17", report["part"].get<std::string>().c_str());
  STRCMP_EQUAL("left", report["foot"].get<std::string>().c_str());
  CHECK(report["size"].is_null());
  DOUBLES_EQUAL(640.5, report["length_mm"].get<double>(), 0);
}

TEST(Part, AShoeThatWasSentBeforeIsToldWithScanAndTime) {
  memory::Memory memory = opened();
  STRCMP_EQUAL("", worked_before(memory, "scan-0003", "A-17").c_str());
  SUCCEEDS(memory.put_scan(sent("scan-0001", "A-17", true), {}));
  STRCMP_EQUAL("part A-17 was worked already: scan-0001, 2026-11-18T11:06:40.000Z",
               worked_before(memory, "scan-0003", "A-17").c_str());
  SUCCEEDS(memory.put_scan(sent("scan-0002", "A-17", false), {}));
  STRCMP_CONTAINS("not to the line's end: scan-0002", worked_before(memory, "scan-0003", "A-17").c_str());
  // It is no other shoe, and not itself.
  STRCMP_EQUAL("", worked_before(memory, "scan-0003", "A-18").c_str());
  STRCMP_EQUAL("", worked_before(memory, "scan-0003", "").c_str());
  SUCCEEDS(memory.put_scan(sent("scan-0004", "A-19", true), {}));
  STRCMP_EQUAL("", worked_before(memory, "scan-0004", "A-19").c_str());
}

TEST(Part, OneThatAScanHasTakenSinceItWasSaidIsUsedUp) {
  memory::Memory memory = opened();
  memory::Scan scan = sent("scan-0001", "A-17*", true);
  SUCCEEDS(memory.put_scan(scan, {}));
  CHECK(is_used_up(memory, "A-17*", scan.time));
  CHECK(!is_used_up(memory, "A-17*", scan.time + 1));
  CHECK(!is_used_up(memory, "A-17", scan.time));
  CHECK(!is_used_up(memory, "A-1*", scan.time));
}

}  // namespace biteline::service
