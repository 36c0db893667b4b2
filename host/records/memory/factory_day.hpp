// SPDX-License-Identifier: MIT
#pragma once
/// \file The factory's day: of its time zone, from the begin of its first shift on.

#include <optional>
#include <string>

#include "common/core/result.hpp"
#include "host/records/memory/memory.hpp"

namespace biteline::memory {

/// In the memory's settings: what the service was started with, for whoever reads its history.
inline constexpr const char* k_zone_key = "time_zone";
inline constexpr const char* k_day_begin_key = "day_begin";

/// From now on local time is this zone's, in the whole process: a name of the time zone database
/// ("Asia/Shanghai") or a POSIX rule ("CST-8").  Empty: the machine's own.  Errc::InvalidArgument: unknown.
/// Before threads begin.
[[nodiscard]] Result<void> use_time_zone(const std::string& zone);
/// Of the process; empty: it has no name.
[[nodiscard]] std::string time_zone();

enum class Span { Hour, Day, Week };
struct Interval {
  UnixMs begin{0}, end{0};
};

/// Thread: a value; local time is the process's.
class FactoryDay {
 public:
  FactoryDay() = default;  ///< from midnight on
  /// "06:00"; nothing: no time of day.
  [[nodiscard]] static std::optional<FactoryDay> from(const std::string& begin);
  /// As the memory's settings have it; where the zone is none, the machine's own stays.
  [[nodiscard]] static FactoryDay of(const Memory& memory);

  [[nodiscard]] std::string begin() const;  ///< "06:00"
  /// What `time` lies in.  A day has 23 or 25 hours where the clock is changed; a week begins on Monday.
  [[nodiscard]] Interval around(UnixMs time, Span span) const;
  /// "2026-11-27": its begin here.  "2026-11-27T07:30" or with seconds: local time; with Z or +08:00 an
  /// instant.
  [[nodiscard]] std::optional<UnixMs> time_of(const std::string& text) const;
  [[nodiscard]] std::string name_of(UnixMs time) const;  ///< of the day that it belongs to: "2026-11-27"

 private:
  explicit FactoryDay(int begin_min) : begin_min_{begin_min} {}
  /// `day` may lie outside its month.
  [[nodiscard]] UnixMs begin_of(int year, int month, int day) const;
  /// Year, month and day of the day that has `time`.
  struct Date {
    int year{0}, month{0}, day{0}, weekday{0};  ///< weekday: 0 Monday
  };
  [[nodiscard]] Date date_of(UnixMs time) const;

  int begin_min_{0};
};

/// "2026-11-27 07:30:05", local.
[[nodiscard]] std::string local_time(UnixMs time);

}  // namespace biteline::memory
