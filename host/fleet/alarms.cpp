// SPDX-License-Identifier: MIT
#include "host/fleet/alarms.hpp"

#include <algorithm>

namespace biteline::fleet {
namespace {

// As in prometheus/rules.yml.
constexpr double k_away_s = 60;
constexpr std::int64_t k_most_waiting = 100;
constexpr double k_most_refused = 0.2;

}  // namespace

std::vector<Alarm> alarms_of(const FleetNews& news, std::span<const LastHour> hours, std::int64_t now_ms) {
  std::vector<Alarm> alarms;
  if (!news.broker) alarms.push_back({.code = "no_broker", .cell = {}, .model = {}, .value = 0});
  for (const CellRow& cell : news.cells) {
    const double silent_s = static_cast<double>(now_ms - cell.heard_ms) / 1000;
    if (!cell.online || silent_s > k_away_s)
      alarms.push_back({.code = "cell_away", .cell = cell.cell, .model = {}, .value = silent_s});
    if (cell.waiting > k_most_waiting)
      alarms.push_back(
          {.code = "shoes_wait", .cell = cell.cell, .model = {}, .value = static_cast<double>(cell.waiting)});
  }
  for (const LastHour& hour : hours) {
    const double share =
        static_cast<double>(hour.refused) / static_cast<double>(std::max<std::int64_t>(1, hour.shoes));
    if (share > k_most_refused)
      alarms.push_back({.code = "many_refused", .cell = hour.cell, .model = {}, .value = share});
  }
  for (const OddOfModel& one : news.odd)
    alarms.push_back({.code = "odd_cell", .cell = one.odd.cell, .model = one.model, .value = one.odd.mm});
  std::ranges::stable_sort(alarms, {}, &Alarm::cell);
  return alarms;
}

}  // namespace biteline::fleet
