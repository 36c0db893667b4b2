// SPDX-License-Identifier: MIT
// A person's word on a scan while the service writes that scan's row.
#include <CppUTest/TestHarness.h>

#include <future>

#include "tests/support/full_disk.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/host/apps/opened_operator_control.hpp"

namespace biteline::service {

using std::chrono::milliseconds;

TEST_GROUP(OperatorControlWords) {
  test::TemporaryFolder folder;
  std::unique_ptr<OperatorControl> sut;

  void setup() override {
    sut = test::opened_operator_control(folder.path());
  }
  void put(const std::string& decision, const std::string& verdict = "amber") {
    memory::Scan row;
    row.name = "scan-0001";
    row.time = 1'000'000;
    row.verdict = verdict;
    row.decision = decision;
    SUCCEEDS(sut->memory().put_scan(row, {}));
  }
  memory::Scan row() {
    const auto found = sut->memory().scan("scan-0001");
    SUCCEEDS(found);
    CHECK(found->has_value());
    return **found;
  }
  std::future<Result<void>> say(api::Decision::Kind kind) {
    return std::async(std::launch::async, [this, kind] {
      return sut->decide({.kind = kind, .scan = "scan-0001", .who = "ada", .why = "a hole", .door = "web"});
    });
  }
  /// Long enough for a word that does not wait to have written its row.
  static void give_time(const std::future<Result<void>>& word) {
    static_cast<void>(word.wait_for(milliseconds{500}));
  }
};

TEST(OperatorControlWords, ARejectionBetweenARowsReadAndItsWriteStays) {
  put("open");
  std::unique_lock words = sut->between_words();
  static_cast<void>(row());
  auto word = say(api::Decision::Kind::Reject);
  give_time(word);
  put("open");
  words.unlock();
  SUCCEEDS(word.get());
  STRCMP_EQUAL("rejected", row().decision.c_str());
  STRCMP_EQUAL("ada", row().decided_by.c_str());
}

TEST(OperatorControlWords, AWordInTheFirstMomentOfAHoldFindsRowAndHold) {
  std::unique_lock words = sut->between_words();
  auto word = say(api::Decision::Kind::Accept);
  give_time(word);
  put("held");
  test::hold_worked(*sut, {.scan = "scan-0001"});
  words.unlock();
  SUCCEEDS(word.get());
  STRCMP_EQUAL("accepted", row().decision.c_str());
  const std::optional<OperatorCommand> command = sut->next_command();
  CHECK(command && command->kind == OperatorCommand::Kind::Send);
}

TEST(OperatorControlWords, AWordThatAFullDiskCannotKeepDoesNothingAndIsHeardOnceThereIsRoom) {
  for (const api::Decision::Kind kind : {api::Decision::Kind::Accept, api::Decision::Kind::Reject}) {
    put("held");
    test::hold_worked(*sut, {.scan = "scan-0001"});
    {
      const test::FullDisk full;
      const Result<void> said = say(kind).get();
      CHECK(!said && said.error().code == Errc::DiskFull);
      CHECK_FALSE(sut->next_command());
      STRCMP_EQUAL("held", row().decision.c_str());
    }
    SUCCEEDS(say(kind).get());
    const std::optional<OperatorCommand> command = sut->next_command();
    CHECK(command && command->kind == (kind == api::Decision::Kind::Accept ? OperatorCommand::Kind::Send
                                                                           : OperatorCommand::Kind::Reject));
  }
}

TEST(OperatorControlWords, AModelNamedInTheFirstMomentOfAHoldIsTaken) {
  std::unique_lock words = sut->between_words();
  auto word =
      std::async(std::launch::async, [this] { return sut->choose_model("scan-0001", "boot", "ada"); });
  give_time(word);
  put("held");
  test::hold_worked(*sut, {.scan = "scan-0001", .waits = Waits::ForModel});
  words.unlock();
  SUCCEEDS(word.get());
  FAILS_NAMING(Errc::WrongState, "does not wait for its model",
               sut->choose_model("scan-0001", "boot", "ada"));
}

}  // namespace biteline::service
