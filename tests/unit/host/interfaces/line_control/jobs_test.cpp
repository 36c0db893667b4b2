// SPDX-License-Identifier: MIT
#include "host/interfaces/line_control/jobs.hpp"

#include <CppUTest/TestHarness.h>

#include "tests/support/errors.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::line_control {

TEST_GROUP(Jobs) {
  test::TemporaryFolder folder;
};

TEST(Jobs, NumberStandsForModelProcessOrNeither) {
  const auto jobs =
      read_jobs(folder.write("jobs.yaml", "jobs:\n  12: {model: boot, process: grind}\n  3: {}\n"));
  SUCCEEDS(jobs);
  LONGS_EQUAL(2, jobs->size());
  LONGS_EQUAL(3, jobs->front().number);
  CHECK(jobs->front().model.empty());
  LONGS_EQUAL(12, jobs->back().number);
  STRCMP_EQUAL("boot", jobs->back().model.c_str());
  STRCMP_EQUAL("grind", jobs->back().process.c_str());
}

TEST(Jobs, NumberStandsForFootAndSizeToo) {
  const auto jobs = read_jobs(
      folder.write("jobs.yaml", "jobs:\n  1: {model: boot, foot: left, size: EU 42}\n  2: {foot: right}\n"));
  SUCCEEDS(jobs);
  STRCMP_EQUAL("left", jobs->front().foot.c_str());
  STRCMP_EQUAL("EU 42", jobs->front().size.c_str());
  STRCMP_EQUAL("right", jobs->back().foot.c_str());
  CHECK(jobs->back().size.empty());
}

TEST(Jobs, FaultNamesTheKey) {
  for (const auto& [text, key] :
       {std::pair{"jobs: {}\n", "jobs"}, std::pair{"jobs:\n  0: {}\n  1: {}\n", "0"},
        std::pair{"jobs:\n  1: {modell: x}\n", "modell"}, std::pair{"jobs:\n  1000: {}\n  2: {}\n", "1000"},
        std::pair{"1: {}\n", "jobs"}, std::pair{"jobs:\n  1: {foot: links}\n", "jobs.1.foot"},
        std::pair{"jobs:\n  1: {size: a text that is longer than any size}\n", "jobs.1.size"},
        std::pair{"jobs:\n  1: {part: A-17}\n", "part"}}) {
    const auto jobs = read_jobs(folder.write("jobs.yaml", text));
    CHECK_TEXT(!jobs, text);
    STRCMP_CONTAINS(key, to_line(jobs.error()).c_str());
  }
}

}  // namespace biteline::line_control
