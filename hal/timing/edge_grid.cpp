// SPDX-License-Identifier: MIT
#include "hal/timing/edge_grid.hpp"

#include <algorithm>
#include <chrono>

namespace biteline::hal {

EdgeVerdict EdgeGrid::on_edge(SensorClock::time_point stamp) {
  if (!slot_time_) {
    slot_time_ = stamp;
    ++health_.slots;
    return EdgeVerdict::OnTime;
  }
  const Nanoseconds since = stamp - *slot_time_;
  const std::int64_t steps = (since + config_.period / 2) / config_.period;
  if (steps <= 0) {
    ++health_.doubled;
    return EdgeVerdict::Doubled;
  }
  ++health_.slots;
  slot_ += static_cast<std::uint64_t>(steps);
  health_.missed += static_cast<std::uint64_t>(steps - 1);
  const Nanoseconds deviation = since - steps * config_.period;
  *slot_time_ += steps * config_.period;
  if (std::chrono::abs(deviation) > config_.tolerance) {
    ++health_.late;
    return EdgeVerdict::Late;
  }
  health_.deviation_max = std::max(health_.deviation_max, std::chrono::abs(deviation));
  // A sixteenth: 100 ppm between the clocks are followed with a lag of 0.2 % of a period, one edge's jitter
  // hardly at all.
  *slot_time_ += deviation / 16;
  return steps > 1 ? EdgeVerdict::AfterMissed : EdgeVerdict::OnTime;
}

}  // namespace biteline::hal
