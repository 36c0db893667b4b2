// SPDX-License-Identifier: MIT
#pragma once
/// \file The pulse generator that triggers camera and strobe: a timer block outside the sensor's processor.

#include <atomic>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>

#include "common/time/clocks.hpp"

namespace biteline::sim {

/// Edges on an even grid from the moment it is switched on.  An edge is told late when this machine is busy,
/// but with the instant it belongs to; the grid never shifts. Thread: configure() from any; the callback on
/// the timer's own thread.
class TriggerTimer {
 public:
  using OnEdge = std::function<void(SensorClock::time_point edge, Nanoseconds pulse)>;
  explicit TriggerTimer(OnEdge on_edge);
  ~TriggerTimer();
  TriggerTimer(const TriggerTimer&) = delete;
  TriggerTimer& operator=(const TriggerTimer&) = delete;

  /// period 0: off.
  void configure(Nanoseconds period, Nanoseconds pulse);
  [[nodiscard]] std::uint64_t edges() const { return edges_.load(); }

 private:
  void run();

  OnEdge on_edge_;
  std::mutex mutex_;
  std::condition_variable changed_;
  Nanoseconds period_{0}, pulse_{0};
  std::uint64_t generation_{0};
  bool stopping_{false};
  std::atomic<std::uint64_t> edges_{0};
  std::thread thread_;
};

}  // namespace biteline::sim
