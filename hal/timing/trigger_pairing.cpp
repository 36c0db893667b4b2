// SPDX-License-Identifier: MIT
#include "hal/timing/trigger_pairing.hpp"

namespace biteline::hal {

void TriggerPairing::on_edge(SensorClock::time_point stamp) {
  if (count_ == k_edges) {
    drop_first();
    ++health_.edges_overrun;
  }
  at(count_) = stamp;
  ++count_;
}

TriggerPairing::Match TriggerPairing::on_frame(SensorClock::time_point stamp) {
  const SensorClock::time_point earliest = stamp - config_.latency_max;
  const SensorClock::time_point latest = stamp - config_.latency_min;
  while (count_ > 0 && at(0) < earliest) {
    drop_first();
    ++health_.edges_without_frame;
  }
  Match match;
  int in_window = 0;
  while (count_ > 0 && at(0) <= latest) {
    match.edge = at(0);
    ++in_window;
    drop_first();
  }
  if (in_window == 1) {
    ++health_.paired;
    return match;
  }
  if (in_window == 0) {
    ++health_.frames_without_edge;
  } else {
    ++health_.frames_with_two_edges;
    match = {.edge = std::nullopt, .ambiguous = true};
  }
  return match;
}

}  // namespace biteline::hal
