// SPDX-License-Identifier: MIT
#include "host/bite_line/place/thing_beside.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace biteline::bite_line {

namespace {

Vec2 level(const PlacedStation& station) {
  return station.position.head<2>();
}

double cross_mm2(const Vec2& a, const Vec2& b) {
  return a.x() * b.y() - a.y() * b.x();
}

/// The middle of a run of stations at which the line turns inwards by a corner, and its sharpest turn.
struct HollowCorner {
  std::size_t station;
  double turn_rad;
};

std::vector<HollowCorner> hollow_corners(const std::vector<PlacedStation>& stations, std::size_t from,
                                         std::size_t to, double corner_rad) {
  const std::size_t count = stations.size();
  const auto at = [&](std::size_t i) { return level(stations[i % count]); };
  std::vector<HollowCorner> corners;
  std::size_t run = 0;
  double sharpest_rad = 0;
  for (std::size_t i = 0; i <= count; ++i) {
    const Vec2 before = at(i + count - from) - at(i + count - to);
    const Vec2 behind = at(i + to) - at(i + from);
    const double inwards_rad = i < count ? -std::atan2(cross_mm2(before, behind), before.dot(behind)) : 0;
    if (inwards_rad > corner_rad) {
      ++run;
      sharpest_rad = std::max(sharpest_rad, inwards_rad);
    } else if (run > 0) {
      corners.push_back({.station = i - 1 - (run - 1) / 2, .turn_rad = sharpest_rad});
      run = 0;
      sharpest_rad = 0;
    }
  }
  return corners;
}

}  // namespace

void doubt_things_beside(double station_mm, std::vector<PlacedStation>& stations, const ThingConfig& config) {
  const std::size_t count = stations.size();
  const auto steps_of = [&](double mm) { return static_cast<std::size_t>(std::lround(mm / station_mm)); };
  const std::size_t beside = steps_of(config.beside_mm);
  if (count <= 2 * steps_of(config.longest_mm)) return;
  constexpr double k_rad_per_deg = std::numbers::pi / 180;
  const std::vector<HollowCorner> corners = hollow_corners(
      stations, steps_of(config.from_mm), steps_of(config.to_mm), config.least_corner_deg * k_rad_per_deg);
  // Any two: a blunt corner may lie between two sharp ones.
  for (std::size_t k = 0; k < corners.size() * corners.size(); ++k) {
    const HollowCorner &out = corners[k / corners.size()], &back = corners[k % corners.size()];
    const std::size_t first = out.station;
    const std::size_t steps = (back.station + count - first) % count;
    if (steps == 0 || steps > steps_of(config.longest_mm)) continue;
    const Vec2 foot = level(stations[first]);
    const Vec2 between = level(stations[(first + steps) % count]) - foot;
    double out_mm = 0;
    for (std::size_t i = 1; i < steps; ++i) {
      // Outwards of an anticlockwise line is to its right.
      const double away = cross_mm2(level(stations[(first + i) % count]) - foot, between);
      out_mm = std::max(out_mm, away / std::max(between.norm(), 1e-6));
    }
    const double sharp_rad = config.corner_deg * k_rad_per_deg;
    const auto [blunter_rad, sharper_rad] = std::minmax(out.turn_rad, back.turn_rad);
    if (sharper_rad < sharp_rad) continue;
    const bool is_pin = steps <= steps_of(config.longest_slanted_mm) && out_mm >= config.least_slanted_mm;
    if (blunter_rad < sharp_rad && !is_pin) continue;
    for (std::size_t i = 0; i <= steps + 2 * beside; ++i) {
      PlacedStation& station = stations[(first + count - beside + i) % count];
      station.thing_beside = true;
      if (config.hold >= station.hold) continue;
      station.hold = config.hold;
      station.other_mm = std::max(station.other_mm, out_mm);
    }
  }
}

}  // namespace biteline::bite_line
