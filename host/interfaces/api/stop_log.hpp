// SPDX-License-Identifier: MIT
#pragma once
/// \file Who said stop, into the memory's log: afterwards, so that no stop waits for the memory.

#include <condition_variable>
#include <deque>
#include <mutex>
#include <string>
#include <thread>

#include "host/interfaces/accounts/accounts.hpp"
#include "host/records/memory/memory.hpp"

namespace biteline::api {

/// Thread: one of its own ("bl-stop-log"); add() is safe from any and waits for nothing.
class StopLog {
 public:
  StopLog(memory::Memory& memory, accounts::Accounts& accounts);
  /// What is not written yet is tried once more.
  ~StopLog();
  StopLog(const StopLog&) = delete;
  StopLog& operator=(const StopLog&) = delete;

  /// `token`: of the session, where the row does not know its person yet.  What one says again within 10 s is
  /// one row: a control that holds its stop says it in each turn.
  void add(memory::LogRow row, std::string token = {});

 private:
  struct Said {
    memory::LogRow row;
    std::string token;
  };
  void run();
  [[nodiscard]] bool write(Said& said);

  memory::Memory& memory_;
  accounts::Accounts& accounts_;
  std::mutex mutex_;
  std::condition_variable said_anything_;
  std::deque<Said> said_;
  memory::LogRow last_;
  bool ending_{false};
  std::thread thread_;  ///< last: it uses the rest
};

}  // namespace biteline::api
