// SPDX-License-Identifier: MIT
#include "firmware/runtime/thread_table.hpp"

#include <CppUTest/TestHarness.h>
#include <sched.h>

#include <cstring>
#include <set>
#include <string>
#include <thread>

#include "firmware/runtime/realtime.hpp"
#include "tests/support/errors.hpp"

namespace biteline::runtime {

TEST_GROUP(ThreadTable){};

TEST(ThreadTable, EveryRowIsSound) {
  std::set<std::string> names;
  for (const ThreadSpec& row : k_thread_table) {
    CHECK(std::strlen(row.name) <= 15);  // the kernel's limit
    CHECK(names.insert(row.name).second);
    CHECK(row.priority >= 1 && row.priority <= 99);
    CHECK(row.budget > Nanoseconds{0});
  }
}

TEST(ThreadTable, NothingStandsAboveTheThreadThatWatchesTheLaser) {
  for (const ThreadSpec& row : k_thread_table) CHECK(row.priority <= threads::k_safety.priority);
}

TEST(ThreadTable, ThreadRunsAsTheTableSaysAndSoDoesWhatItStarts) {
  Result<void> entered;
  int policy = -1, child_policy = -1;
  std::thread{[&] {
    entered = enter_thread(threads::k_stream, RealtimeDemand::Required);
    policy = sched_getscheduler(0);
    std::thread{[&] { child_policy = sched_getscheduler(0); }}.join();
  }}.join();
  if (!entered) {
    CHECK(entered.error().code == Errc::NoRights);
    return;
  }
  LONGS_EQUAL(SCHED_FIFO, policy);
  LONGS_EQUAL(SCHED_FIFO, child_policy);
}

TEST(ThreadTable, LentPriorityIsThatOfTheThreadsMadeMeanwhile) {
  int policy_meanwhile = -1, policy_after = -1, own_policy_after = -1;
  std::thread{[&] {
    {
      const auto lent = LentPriority::lend(threads::k_network, RealtimeDemand::Required);
      if (!lent) return;
      std::thread{[&] { policy_meanwhile = sched_getscheduler(0); }}.join();
    }
    own_policy_after = sched_getscheduler(0);
    std::thread{[&] { policy_after = sched_getscheduler(0); }}.join();
  }}.join();
  if (policy_meanwhile < 0) return;  // no rights
  LONGS_EQUAL(SCHED_FIFO, policy_meanwhile);
  LONGS_EQUAL(SCHED_OTHER, own_policy_after);
  LONGS_EQUAL(SCHED_OTHER, policy_after);
}

TEST(ThreadTable, IgnoredDemandIsNeverRefused) {
  SUCCEEDS(prepare_process(RealtimeDemand::Ignored));
  SUCCEEDS(enter_thread(threads::k_stream, RealtimeDemand::Ignored));
}

}  // namespace biteline::runtime
