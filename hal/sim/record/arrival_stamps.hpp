// SPDX-License-Identifier: MIT
#pragma once
/// \file Stamps of a camera without a trigger: when its pictures came, not when they were taken.

#include <cstdint>
#include <span>
#include <vector>

#include "common/time/clocks.hpp"

namespace biteline::sim {

struct ArrivalStamps {
  /// Beyond the least delay each picture comes later by an exponential law of this mean: bus and scheduler.
  double jitter_ms{0};
  /// Of the delay's mean, what the calibration of the clock did not find.
  double unknown_late_ms{0};
  /// The camera stamps by a clock of its own, which is mapped by the least delays as the Aravis backend does;
  /// else the arrival itself is the stamp.
  bool camera_stamps{false};
};

/// What such a camera's pictures would be stamped with, strictly rising.  The delay's mean is taken off, as
/// the calibration of the pose clock does.  Same arguments, same stamps.
[[nodiscard]] std::vector<SensorClock::time_point> arrival_stamps(
    std::span<const SensorClock::time_point> exposure_mids, const ArrivalStamps& settings,
    std::uint64_t seed);

}  // namespace biteline::sim
