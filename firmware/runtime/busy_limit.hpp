// SPDX-License-Identifier: MIT
#pragma once
/// \file How much of its processor a real-time thread may take.

#include <algorithm>

#include "common/time/clocks.hpp"

namespace biteline::runtime {

/// Finds when a thread has to sleep of its own accord.
///
/// A thread of SCHED_FIFO whose next frame is always there already never gives its processor back.  What the
/// kernel holds for that processor alone stands still with it, the network's soft interrupts first: then no
/// host is heard, not even one that asks for darkness.  So the thread waits for a tenth of the time at least,
/// for frames or, when there are too many, for nothing.  Frames missed meanwhile are losses of the driver's,
/// counted as such.
///
/// Thread: one owner.
class BusyLimit {
 public:
  /// Of the time between two waits for frames: `waited` of it the thread slept.  Returns how long it has to
  /// sleep now, mostly 0.
  [[nodiscard]] Nanoseconds rest_due(SensorClock::time_point now, Nanoseconds waited) {
    if (begin_ == SensorClock::time_point{}) begin_ = now - waited;
    waited_ += waited;
    if (now - begin_ < k_stretch) return Nanoseconds{0};
    const Nanoseconds owed = std::clamp((now - begin_) / k_least_share - waited_, Nanoseconds{0}, k_longest);
    begin_ = now + owed;
    waited_ = Nanoseconds{0};
    return owed;
  }

 private:
  /// The laser guard's time for a host that asks for darkness.
  static constexpr Nanoseconds k_stretch = std::chrono::milliseconds{100};
  /// A frame takes half of its period at most (thread_table.hpp), so that a tenth is never missed.
  static constexpr int k_least_share = 10;
  /// Below the laser guard's patience with the frame thread (50 ms).
  static constexpr Nanoseconds k_longest = std::chrono::milliseconds{20};

  SensorClock::time_point begin_{};
  Nanoseconds waited_{0};
};

}  // namespace biteline::runtime
