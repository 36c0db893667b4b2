// SPDX-License-Identifier: MIT
#include "host/fleet/recording_limits.hpp"

namespace biteline::fleet {

std::vector<Going> beyond(const RecordingLimits& limits, const std::vector<KeptRecording>& kept) {
  double bytes = 0;
  for (const KeptRecording& one : kept) bytes += static_cast<double>(one.bytes);
  std::vector<Going> going;
  for (const KeptRecording& one : kept) {
    if (one.marked || one.busy) continue;
    const bool old = limits.days && one.age_days > *limits.days;
    const bool newest = one.number == kept.back().number;
    const bool no_room = limits.gb && bytes > 1e9 * *limits.gb && !newest;
    if (!old && !no_room) continue;
    going.push_back({.number = one.number, .by = old ? GoesBy::Age : GoesBy::Space});
    bytes -= static_cast<double>(one.bytes);
  }
  return going;
}

}  // namespace biteline::fleet
