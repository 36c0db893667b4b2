// SPDX-License-Identifier: MIT
#include "hal/linux/pwm/pulse_grid.hpp"

#include <algorithm>

namespace biteline::hal {

bool PulseGrid::on_wake(SensorClock::time_point now) {
  const Nanoseconds late = now - next_;
  if (late < period_ / 2) {
    health_.late_max = std::max(health_.late_max, late);
    ++health_.pulses;
    next_ += period_;
    return true;
  }
  const std::int64_t slots = (late + period_ / 2) / period_;
  health_.slots_skipped += static_cast<std::uint64_t>(slots);
  next_ += slots * period_;
  return false;
}

}  // namespace biteline::hal
