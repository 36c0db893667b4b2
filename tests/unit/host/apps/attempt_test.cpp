// SPDX-License-Identifier: MIT
#include "host/apps/biteline-host/attempt.hpp"

#include <CppUTest/TestHarness.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/support/errors.hpp"
#include "tests/support/json.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::service {

TEST_GROUP(Attempt) {
  test::TemporaryFolder folder;

  nlohmann::json report() const {
    std::ifstream stream{folder.path() / "report.json"};
    return test::read_json(stream);
  }
};

TEST(Attempt, MarkOutlivesTheProcessUntilItIsCleared) {
  CHECK(!was_attempted(folder.path()));
  SUCCEEDS(mark_attempt(folder.path()));
  CHECK(was_attempted(folder.path()));
  clear_attempt(folder.path());
  CHECK(!was_attempted(folder.path()));
}

TEST(Attempt, ScanThatIsSetAsideSaysWhyAndKeepsItsRecording) {
  folder.write("scan.btln", "recording");
  SUCCEEDS(mark_attempt(folder.path()));
  SUCCEEDS(set_aside(folder.path(), "out of memory"));
  STRCMP_EQUAL("refused", report().value("status", "").c_str());
  STRCMP_EQUAL("scan_set_aside", report().value("reason_code", "").c_str());
  STRCMP_CONTAINS("out of memory", report().value("reason", "").c_str());
  CHECK(std::filesystem::exists(folder.path() / "scan.btln"));
  CHECK(!was_attempted(folder.path()));
}

TEST(Attempt, MarkThatCannotBeWrittenIsTold) {
  CHECK(!mark_attempt(folder.path() / "gone").has_value());
}

}  // namespace biteline::service
