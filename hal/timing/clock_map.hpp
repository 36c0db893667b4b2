// SPDX-License-Identifier: MIT
#pragma once
/// \file Another device's clock on the sensor's clock, from stamps that arrive late by an unknown, varying
/// delay.
///
/// Each arrival says: offset <= received - stamp.  The least of them in a stretch of time came with the least
/// delay, so a line through such minima follows the offset and the drift, and how far the minima scatter
/// about it says how sure it is.

#include <array>
#include <cstdint>
#include <optional>

#include "common/time/clocks.hpp"
#include "hal/api/clock_health.hpp"

namespace biteline::hal {

struct ClockMapHealth {
  std::uint64_t samples{0};
  std::uint64_t late{0};       ///< arrived later than step_threshold: not used
  std::uint64_t steps{0};      ///< times that the other clock jumped and the map began anew
  Nanoseconds offset{0};       ///< sensor clock minus the other, now
  Nanoseconds uncertainty{0};  ///< of the offset
  double drift_ppm{0};
  bool ready{false};
};

/// The part that goes into a device's health.
[[nodiscard]] inline ClockHealth clock_health(const ClockMapHealth& map) {
  return {.known = map.ready,
          .offset = map.offset,
          .uncertainty = map.uncertainty,
          .drift_ppm = map.drift_ppm,
          .steps = map.steps};
}

/// Works on plain counts; ClockMap below adds the clock's type.
/// Thread: one owner.  RT: no allocation, a fit over at most k_buckets points when a bucket closes.
class ClockMapCore {
 public:
  struct Config {
    Nanoseconds bucket{250'000'000};  ///< at 125 arrivals a second 31 of them: one is near the least delay
    Nanoseconds step_threshold{20'000'000};  ///< further off than any delay of a working network
    int late_run{25};                        ///< so many late arrivals in a row are a clock that was set back
    double drift_max_ppm{200};               ///< twice the worst crystal
    Nanoseconds delay_min{0};                ///< least delay of the path, where known
    Nanoseconds delay_uncertainty{0};        ///< of delay_min; joins the uncertainty
  };
  explicit ClockMapCore(const Config& config) : config_{config} {}

  enum class Verdict { Used, Late, Stepped };
  struct Arrival {
    std::int64_t stamp_ns{0};     ///< on the other clock
    std::int64_t received_ns{0};  ///< on the sensor's
  };
  Verdict add(Arrival arrival);

  /// Sensor time of `stamp_ns`; nothing before the first bucket is full.
  [[nodiscard]] std::optional<std::int64_t> to_sensor_ns(std::int64_t stamp_ns) const;
  [[nodiscard]] ClockMapHealth health() const;

 private:
  struct Point {
    std::int64_t stamp_ns{0};
    std::int64_t offset_ns{0};
  };
  static constexpr std::size_t k_buckets = 32;

  void restart(Point first);
  void close_bucket();
  void fit();
  [[nodiscard]] std::int64_t offset_at(std::int64_t stamp_ns) const;

  Config config_;
  std::array<Point, k_buckets> minima_{};
  std::size_t minima_count_{0};
  std::size_t oldest_{0};
  Point best_{};
  std::int64_t bucket_end_ns_{0};
  bool started_{false};
  int late_in_a_row_{0};
  // offset(t) = base + slope * (t - origin)
  std::int64_t origin_ns_{0};
  std::int64_t base_ns_{0};
  double slope_{0};
  std::int64_t scatter_ns_{0};
  ClockMapHealth counts_;
};

template <class Remote>
class ClockMap {
 public:
  explicit ClockMap(const ClockMapCore::Config& config = {}) : core_{config} {}

  ClockMapCore::Verdict add(typename Remote::time_point stamp, SensorClock::time_point received) {
    return core_.add(
        {.stamp_ns = stamp.time_since_epoch().count(), .received_ns = received.time_since_epoch().count()});
  }
  [[nodiscard]] std::optional<SensorClock::time_point> to_sensor(typename Remote::time_point stamp) const {
    const std::optional<std::int64_t> sensor_ns = core_.to_sensor_ns(stamp.time_since_epoch().count());
    if (!sensor_ns) return std::nullopt;
    return SensorClock::time_point{Nanoseconds{*sensor_ns}};
  }
  [[nodiscard]] ClockMapHealth health() const { return core_.health(); }

 private:
  ClockMapCore core_;
};

}  // namespace biteline::hal
