// SPDX-License-Identifier: MIT
#pragma once
/// \file Whether this machine had time for the demo.

#include <algorithm>
#include <atomic>
#include <chrono>
#include <stop_token>
#include <thread>

namespace biteline::demo {

/// A thread that asks to be woken every 5 ms while it lives and notes the longest delay: what sensor and
/// cell, as ordinary programs, had to wait for the processor.
class Lateness {
 public:
  Lateness()
      : thread_{[this](const std::stop_token& stop) {
          using Clock = std::chrono::steady_clock;
          while (!stop.stop_requested()) {
            const Clock::time_point due = Clock::now() + std::chrono::milliseconds{5};
            std::this_thread::sleep_until(due);
            worst_ms_ = std::max(worst_ms_.load(),
                                 std::chrono::duration<double, std::milli>(Clock::now() - due).count());
          }
        }} {}

  [[nodiscard]] double worst_ms() const { return worst_ms_; }
  /// Less than that the laser's guard forgives: 50 ms without a sign of life of a thread that waits 20 ms by
  /// itself and works for 5.
  static constexpr double k_allowed_ms = 25;

 private:
  std::atomic<double> worst_ms_{0};
  std::jthread thread_;  ///< last: it writes the above
};

}  // namespace biteline::demo
