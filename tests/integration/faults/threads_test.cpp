// SPDX-License-Identifier: MIT
// The real program's threads while it scans: as urgent as the table says, and none that spins.
#include <CppUTest/TestHarness.h>
#include <sched.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "firmware/runtime/thread_table.hpp"
#include "tests/integration/faults/fault_stand.hpp"
#include "tests/support/shared_data.hpp"

namespace biteline::test {
namespace {

struct Thread {
  int policy{-1}, priority{-1};
  double processor_s{0};  ///< used so far
};

Thread thread_of(const std::filesystem::path& task) {
  Thread thread;
  const int tid = std::stoi(task.filename());
  sched_param parameters{};
  thread.policy = sched_getscheduler(tid);
  sched_getparam(tid, &parameters);
  thread.priority = parameters.sched_priority;
  // proc(5), stat: after the name in brackets the 12th and 13th are user and system time, in ticks.
  std::string line;
  std::getline(std::ifstream{task / "stat"} >> std::ws, line);
  const std::size_t name_end = line.rfind(") ");
  if (name_end == std::string::npos) return thread;  // it has ended since it was listed
  std::istringstream rest{line.substr(name_end + 2)};
  std::string word;
  for (int i = 0; i < 11; ++i) rest >> word;
  double user_ticks = 0, system_ticks = 0;
  rest >> user_ticks >> system_ticks;
  thread.processor_s = (user_ticks + system_ticks) / static_cast<double>(sysconf(_SC_CLK_TCK));
  return thread;
}

/// By name; of several of one name the most urgent one, at the least urgent one's policy.
std::map<std::string, Thread> threads_of(int pid) {
  std::map<std::string, Thread> threads;
  for (const auto& task : std::filesystem::directory_iterator{"/proc/" + std::to_string(pid) + "/task"}) {
    std::string name;
    if (!std::getline(std::ifstream{task.path() / "comm"}, name)) continue;
    const Thread thread = thread_of(task.path());
    Thread& known = threads[name];
    const bool ordinary = known.policy == SCHED_OTHER || thread.policy == SCHED_OTHER;
    if (thread.priority > known.priority) known = thread;
    if (ordinary) known.policy = SCHED_OTHER;
  }
  return threads;
}

}  // namespace

TEST_GROUP(SensorThreads) {
  std::unique_ptr<FaultStand> stand;
};

TIMED_TEST(SensorThreads, EveryOneIsAsUrgentAsTheTableSays) {
  stand = FaultStand::set_up();
  if (!stand) return;
  const auto refused = stand->start_scan();
  CHECK_TEXT(!refused, refused.value_or("").c_str());
  std::map<std::string, Thread> threads = threads_of(stand->sensor().child().pid());
  for (const runtime::ThreadSpec& row : runtime::k_thread_table) {
    // Nothing is recorded here.
    if (row.name == runtime::threads::k_record.name) {
      CHECK_TEXT(!threads.contains(row.name), row.name);
      continue;
    }
    CHECK_TEXT(threads.contains(row.name), row.name);
    LONGS_EQUAL_TEXT(stand->urgent() ? SCHED_FIFO : SCHED_OTHER, threads[row.name].policy, row.name);
    LONGS_EQUAL_TEXT(stand->urgent() ? row.priority : 0, threads[row.name].priority, row.name);
  }
  // A killed process lets go of its lines only when its last thread is gone.
  for (const auto& [name, thread] : threads)
    LONGS_EQUAL_TEXT(stand->urgent() ? SCHED_FIFO : SCHED_OTHER, thread.policy, name.c_str());
}

/// A real-time thread that spins leaves its processor's ordinary ones to the kernel's own rescue, which stops
/// every real-time thread there for 50 ms: as long as the laser's guard waits for a sign of life.  Without
/// poses profiles always wait for them, so this is when one is tempted to.
TIMED_TEST(SensorThreads, NoneSpinsWhileProfilesWaitForPoses) {
  constexpr double k_most_share = 0.5;
  stand = FaultStand::set_up();
  if (!stand) return;
  const auto refused = stand->start_scan();
  CHECK_TEXT(!refused, refused.value_or("").c_str());
  stand->cell().faults.bus_off = true;
  CHECK(stand->take_profiles(10));
  const int pid = stand->sensor().child().pid();
  const auto begin = std::chrono::steady_clock::now();
  std::map<std::string, Thread> before = threads_of(pid);
  CHECK(stand->take_profiles(100));
  std::map<std::string, Thread> after = threads_of(pid);
  const double wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  for (const runtime::ThreadSpec& row : runtime::k_thread_table) {
    const double share = (after[row.name].processor_s - before[row.name].processor_s) / wall_s;
    std::printf("%s: %.0f %% of a processor\n", row.name, 100 * share);
    CHECK_TEXT(share < k_most_share, row.name);
  }
}

}  // namespace biteline::test
