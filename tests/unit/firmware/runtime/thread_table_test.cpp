// SPDX-License-Identifier: MIT
#include "firmware/runtime/thread_table.hpp"

#include <CppUTest/TestHarness.h>

#include <cstring>
#include <set>
#include <string>

#include "firmware/runtime/realtime.hpp"
#include "tests/support/errors.hpp"

namespace biteline::runtime {

TEST_GROUP(ThreadTable) {};

TEST(ThreadTable, EveryRowIsSound) {
  std::set<std::string> names;
  for (const ThreadSpec& row : k_thread_table) {
    CHECK(std::strlen(row.name) <= 15);  // the kernel's limit
    CHECK(names.insert(row.name).second);
    CHECK(row.policy == Policy::Fifo ? row.priority >= 1 && row.priority <= 99 : row.priority == 0);
    CHECK(row.budget > Nanoseconds{0});
  }
}

TEST(ThreadTable, NothingStandsAboveTheThreadThatWatchesTheLaser) {
  for (const ThreadSpec& row : k_thread_table) CHECK(row.priority <= threads::k_safety.priority);
}

TEST(ThreadTable, IgnoredDemandIsNeverRefused) {
  SUCCEEDS(prepare_process(RealtimeDemand::Ignored));
  SUCCEEDS(enter_thread(threads::k_stream, RealtimeDemand::Ignored));
}

}  // namespace biteline::runtime
