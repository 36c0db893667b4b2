// SPDX-License-Identifier: MIT
#pragma once
/// \file How late this machine wakes a thread that nothing of ours holds up.

#include <atomic>
#include <chrono>
#include <memory>
#include <stop_token>
#include <thread>
#include <vector>

namespace biteline::test {

/// One thread on each processor of this process.  Each asks to be woken every 2 ms and notes by how much that
/// fails.  An urgent one is above all others where there are real-time rights: what it misses, the kernel or
/// the machine below it stood still.  An ordinary one (or one without rights) also misses what other programs
/// had.
/// Thread: public methods from any.
class WakeupProbe {
 public:
  using Clock = std::chrono::steady_clock;

  enum class Rank { Urgent, Ordinary };
  explicit WakeupProbe(Rank rank = Rank::Urgent);
  ~WakeupProbe() = default;  // the threads end first
  WakeupProbe(const WakeupProbe&) = delete;
  WakeupProbe& operator=(const WakeupProbe&) = delete;

  /// Real-time rights were there.
  [[nodiscard]] bool urgent() const { return urgent_; }
  /// The most time within any `window` so far in which the machine did not do as asked; what still lasts
  /// included.
  [[nodiscard]] double worst_ms(std::chrono::milliseconds window = std::chrono::milliseconds{100}) const;
  /// Time between the two instants in which one processor at least did not do as asked.
  [[nodiscard]] double stalled_ms(Clock::time_point from, Clock::time_point until) const;

 private:
  /// Delays below that are the price of waking anyone and are not noted.
  static constexpr std::chrono::microseconds k_noted{500};
  static constexpr std::size_t k_most_delays = 65536;  ///< of one test: two minutes of nothing else
  struct Delay {
    std::int64_t due_ns, woken_ns;
  };
  /// Written by its thread, read by any: no lock, which a reader of low priority could hold.
  struct Lane {
    std::atomic<std::int64_t> due_ns{0};  ///< 0: it runs
    std::vector<Delay> delays = std::vector<Delay>(k_most_delays);
    std::atomic<std::size_t> count{0};
  };
  void run(Lane& lane, int processor, const std::stop_token& stop);
  /// In order of time, none overlapping another: both processors often stand still together.
  [[nodiscard]] std::vector<Delay> stalls() const;

  std::vector<std::unique_ptr<Lane>> lanes_;
  std::atomic<bool> urgent_;
  std::vector<std::jthread> threads_;  ///< last: they write to the rest
};

}  // namespace biteline::test
