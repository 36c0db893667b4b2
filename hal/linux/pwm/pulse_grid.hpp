// SPDX-License-Identifier: MIT
#pragma once
/// \file The phase grid of a software-timed pulse train: when the next pulse is due, and what was missed.

#include <cstdint>

#include "common/time/clocks.hpp"

namespace biteline::hal {

struct PulseHealth {
  std::uint64_t pulses{0};
  std::uint64_t slots_skipped{0};  ///< woken too late for them: no pulse, and none made up for
  Nanoseconds late_max{0};
};

/// Pulses stand at start + n * period for ever: a late wake-up never shifts the grid.
/// Thread: one owner.  RT: arithmetic only.
class PulseGrid {
 public:
  PulseGrid(SensorClock::time_point start, Nanoseconds period) : next_{start}, period_{period} {}

  /// Another grid from here on; the counts go on.
  void regrid(SensorClock::time_point start, Nanoseconds period) {
    next_ = start;
    period_ = period;
  }

  [[nodiscard]] SensorClock::time_point next() const { return next_; }

  /// Woken for next() at `now`.  true: give the pulse; false: the slot is over, skip to the next one.
  /// A pulse later than half a period would be taken for its neighbour, so it is not given.
  bool on_wake(SensorClock::time_point now);

  [[nodiscard]] const PulseHealth& health() const { return health_; }

 private:
  SensorClock::time_point next_;
  Nanoseconds period_;
  PulseHealth health_;
};

}  // namespace biteline::hal
