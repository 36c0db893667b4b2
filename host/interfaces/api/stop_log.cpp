// SPDX-License-Identifier: MIT
#include "host/interfaces/api/stop_log.hpp"

#include <pthread.h>

#include <chrono>
#include <utility>

namespace biteline::api {
namespace {

constexpr memory::UnixMs k_one_row_ms = 10'000;
/// More wait only where the memory is away for long; the deeds are done.
constexpr std::size_t k_most = 64;
constexpr std::chrono::seconds k_before_retry{1};

}  // namespace

StopLog::StopLog(memory::Memory& memory, accounts::Accounts& accounts)
    : memory_{memory}, accounts_{accounts}, thread_{[this] { run(); }} {}

StopLog::~StopLog() {
  {
    const std::lock_guard lock{mutex_};
    ending_ = true;
  }
  said_anything_.notify_all();
  thread_.join();
}

void StopLog::add(memory::LogRow row, std::string token) {
  {
    const std::lock_guard lock{mutex_};
    const bool again = row.who == last_.who && row.door == last_.door && row.action == last_.action &&
                       row.time >= last_.time && row.time - last_.time < k_one_row_ms;
    if (again || said_.size() >= k_most) return;
    last_ = row;
    said_.push_back({.row = std::move(row), .token = std::move(token)});
  }
  said_anything_.notify_all();
}

bool StopLog::write(Said& said) {
  if (!said.token.empty()) {
    const Result<std::optional<accounts::Person>> person = accounts_.who_is(said.token);
    if (!person) return false;
    if (*person) said.row.who = (*person)->name;
    said.token.clear();
  }
  return memory_.log(said.row).has_value();
}

void StopLog::run() {
  pthread_setname_np(pthread_self(), "bl-stop-log");
  std::unique_lock lock{mutex_};
  while (true) {
    said_anything_.wait(lock, [this] { return ending_ || !said_.empty(); });
    if (said_.empty()) return;
    Said next = said_.front();
    lock.unlock();
    const bool written = write(next);
    lock.lock();
    if (written || ending_) {
      said_.pop_front();
    } else {
      said_.front() = std::move(next);
      said_anything_.wait_for(lock, k_before_retry, [this] { return ending_; });
    }
  }
}

}  // namespace biteline::api
