// SPDX-License-Identifier: MIT
// `biteline work-force` on a memory that is made here.
#include <CppUTest/TestHarness.h>

#include <nlohmann/json.hpp>

#include "host/intake/child_process.hpp"
#include "host/records/force_book/force_book.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline {

TEST_GROUP(WorkForceTool) {
  test::TemporaryFolder folder;
  const force_book::Subject of{
      .model = "oxford", .foot = "left", .process = "grind", .process_sha256 = "aa", .tip = {}};

  /// Shoes whose tip goes farther in by `wear_mm` each.
  void work(int shoes, double wear_mm) {
    auto memory = memory::Memory::open(folder.path() / memory::k_memory_file);
    SUCCEEDS(memory);
    for (int i = 1; i <= shoes; ++i) {
      path::ForceTold told{.samples = 10, .within = 0.97, .mean_newton = 19.5, .largest_newton = 23};
      told.along_mm = wear_mm * i + (i % 2 == 0 ? 0.001 : -0.001);
      told.learn.push_back({0, Vec3{-19, 0, 0}, Vec3::UnitX()});
      SUCCEEDS(force_book::learn_shoe(*memory, of, 20, "scan-" + std::to_string(i), told));
    }
  }
  struct Said {
    int status{0};
    std::string out, last_error;
  };
  Said tell(std::vector<std::string> more = {}) const {
    std::vector<std::string> arguments{"work-force", folder.path().string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    auto child = intake::ChildProcess::start({.program = BITELINE_TOOL, .arguments = arguments});
    SUCCEEDS(child);
    Said said;
    while (const auto line = child->next_line(std::chrono::seconds{30})) said.out += *line + "\n";
    said.status = child->wait(std::chrono::seconds{30}).value_or(-1);
    said.last_error = child->last_words();
    return said;
  }
};

TEST(WorkForceTool, TellsWhatWasLearnedAndWhenTheReachIsUsedUp) {
  work(20, 0.05);
  const Said said = tell({"--json"});
  LONGS_EQUAL(0, said.status);
  const auto json = nlohmann::json::parse(said.out);
  const auto& learned = json.at("learned").at(0);
  STRCMP_EQUAL("oxford", learned.at("model").get<std::string>().c_str());
  LONGS_EQUAL(20, learned.at("shoes").get<int>());
  // 0.05 mm a shoe reaches 3 mm at shoe 60; the made scatter of 1 um shifts it by less than a shoe.
  CHECK(learned.at("wear").at("sure").get<bool>());
  DOUBLES_EQUAL(60, learned.at("wear").at("reaches").at("shoe").get<double>(), 1);
  STRCMP_CONTAINS("learned from 20 shoes", tell().out.c_str());
}

TEST(WorkForceTool, AToolThatDoesNotWearIsToldSo) {
  work(20, 0);
  const Said said = tell();
  LONGS_EQUAL(0, said.status);
  STRCMP_CONTAINS("no wear", said.out.c_str());
}

TEST(WorkForceTool, ForgetsAModelAndNamesOneThatIsNotThere) {
  work(1, 0);
  CHECK(tell({"--forget", "derby"}).status != 0);
  LONGS_EQUAL(0, tell({"--forget", "oxford", "--who", "eng"}).status);
  STRCMP_CONTAINS("no shoe has taught a force yet", tell().out.c_str());
}

}  // namespace biteline
