// SPDX-License-Identifier: MIT
#include "hal/sim/record/arrival_stamps.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "hal/sim/shoe/random.hpp"
#include "hal/timing/clock_map.hpp"

namespace biteline::sim {

namespace {

/// Of a cheap camera's crystal against the computer's.
constexpr double k_drift_ratio = 30e-6;
/// Two arrivals are never the same instant.
constexpr Nanoseconds k_least_apart{1'000};

Nanoseconds milliseconds(double ms) {
  return Nanoseconds{std::llround(ms * 1e6)};
}

}  // namespace

std::vector<SensorClock::time_point> arrival_stamps(std::span<const SensorClock::time_point> exposure_mids,
                                                    const ArrivalStamps& settings, std::uint64_t seed) {
  Random random = Random(seed).fork(7);
  hal::ClockMapCore line{{}};
  std::int64_t least_ns = std::numeric_limits<std::int64_t>::max();
  // What the clock's calibration finds: the mean delay of arrivals; of mapped stamps the least delay, here 0.
  const Nanoseconds known = settings.camera_stamps ? Nanoseconds{0} : milliseconds(settings.jitter_ms);
  std::vector<SensorClock::time_point> stamps;
  for (const SensorClock::time_point mid : exposure_mids) {
    const double delay_ms = -settings.jitter_ms * std::log(random.uniform({1e-12, 1}));
    SensorClock::time_point stamp = mid + milliseconds(delay_ms);
    if (settings.camera_stamps) {
      const Nanoseconds since = mid - exposure_mids.front();
      const auto camera_ns =
          static_cast<std::int64_t>(std::llround(static_cast<double>(since.count()) * (1 + k_drift_ratio)));
      const std::int64_t arrived_ns = stamp.time_since_epoch().count();
      least_ns = std::min(least_ns, arrived_ns - camera_ns);
      line.add({.stamp_ns = camera_ns, .received_ns = arrived_ns});
      stamp =
          SensorClock::time_point{Nanoseconds{line.to_sensor_ns(camera_ns).value_or(camera_ns + least_ns)}};
    }
    stamp += milliseconds(settings.unknown_late_ms) - known;
    if (!stamps.empty()) stamp = std::max(stamp, stamps.back() + k_least_apart);
    stamps.push_back(stamp);
  }
  return stamps;
}

}  // namespace biteline::sim
