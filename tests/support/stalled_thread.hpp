// SPDX-License-Identifier: MIT
#pragma once
/// \file A thread of another process that hangs.

#include <string>

namespace biteline::test {

/// One thread of another process that goes into its next wait and does not come back (ptrace), as in a driver
/// that never returns.  There it holds nothing that another thread waits for.
class StalledThread {
 public:
  /// `name` as the thread table has it.
  StalledThread(int pid, const std::string& name);
  ~StalledThread();
  StalledThread(const StalledThread&) = delete;
  StalledThread& operator=(const StalledThread&) = delete;
  [[nodiscard]] bool stalled() const { return tid_ > 0; }

 private:
  void run_into_wait();

  int tid_{0};
};

}  // namespace biteline::test
