// SPDX-License-Identifier: MIT
#include "tests/support/stalled_thread.hpp"

#include <sys/ptrace.h>
#include <sys/syscall.h>
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdint>
#include <filesystem>
#include <fstream>

namespace biteline::test {
namespace {

/// It is about to wait for a device, a message or the time, and holds no lock.
bool begins_a_wait(int tid) {
  __ptrace_syscall_info call{};
  ptrace(PTRACE_GET_SYSCALL_INFO, tid, sizeof call, &call);
  if (call.op != PTRACE_SYSCALL_INFO_ENTRY) return false;
  constexpr std::array k_waits{SYS_ppoll, SYS_poll, SYS_clock_nanosleep};
  const auto number = static_cast<long>(call.entry.nr);
  // Aravis' queue of frames waits on a condition until some moment; a lock that is taken is waited for
  // without.
  constexpr std::uint64_t k_until_some_moment = 9;  // FUTEX_WAIT_BITSET
  const bool on_condition = number == SYS_futex && (call.entry.args[1] & 0x7FU) == k_until_some_moment;
  return on_condition || std::find(k_waits.begin(), k_waits.end(), number) != k_waits.end();
}

}  // namespace

StalledThread::StalledThread(int pid, const std::string& name) {
  const std::filesystem::path tasks = std::filesystem::path{"/proc"} / std::to_string(pid) / "task";
  for (const auto& task : std::filesystem::directory_iterator{tasks}) {
    std::string comm;
    std::ifstream{task.path() / "comm"} >> comm;
    if (comm != name) continue;
    const int tid = std::stoi(task.path().filename());
    if (ptrace(PTRACE_SEIZE, tid, nullptr, PTRACE_O_TRACESYSGOOD) != 0) return;
    tid_ = tid;
    ptrace(PTRACE_INTERRUPT, tid, nullptr, nullptr);
    run_into_wait();
    return;
  }
}

void StalledThread::run_into_wait() {
  constexpr int k_at_system_call = SIGTRAP | 0x80;  // PTRACE_O_TRACESYSGOOD
  while (true) {
    int status = 0;
    if (waitpid(tid_, &status, __WALL) != tid_ || !WIFSTOPPED(status)) {
      tid_ = 0;
      return;
    }
    if (WSTOPSIG(status) == k_at_system_call && begins_a_wait(tid_)) return;
    ptrace(PTRACE_SYSCALL, tid_, nullptr, nullptr);
  }
}

StalledThread::~StalledThread() {
  if (tid_ > 0) ptrace(PTRACE_DETACH, tid_, nullptr, nullptr);
}

}  // namespace biteline::test
