// SPDX-License-Identifier: MIT
#pragma once
/// \file Clients of /api/v1/live, each on a thread of its own: what they get, in what order, how late.

#include <atomic>
#include <cstdint>
#include <string>
#include <thread>
#include <vector>

namespace biteline::bench {

/// What a watcher does with what comes.
enum class Reading {
  All,   ///< reads as fast as it comes
  Page,  ///< and decodes each picture, as a page does
  Slow,  ///< one message in half a second
};

class Watcher {
 public:
  Watcher(std::uint16_t port, const std::string& token, Reading reading)
      : thread_{[this, port, token, reading] { watch(port, token, reading); }} {}
  ~Watcher() { stop(); }
  Watcher(const Watcher&) = delete;
  Watcher& operator=(const Watcher&) = delete;
  void stop() {
    stopping_ = true;
    if (thread_.joinable()) thread_.join();
  }

  // After stop().
  std::uint64_t pictures{0}, profiles{0};
  int older{0};   ///< messages of a kind that are older than the one before
  int broken{0};  ///< pictures that cannot be decoded (Reading::Page)
  bool connected{false};
  std::vector<double> late_ms;  ///< of profiles: mid-exposure to here

 private:
  void watch(std::uint16_t port, const std::string& token, Reading reading);
  void take(const std::string& message, Reading reading);

  std::uint64_t picture_ns_{0}, profile_ns_{0};  ///< of the newest
  std::atomic<bool> stopping_{false};
  std::thread thread_;  ///< last: it uses the rest
};

}  // namespace biteline::bench
