// SPDX-License-Identifier: MIT
#include "host/bite_line/place/thing_beside.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>

namespace biteline::bite_line {

namespace {

constexpr double k_rad_per_deg = std::numbers::pi / 180;

Vec2 level(const PlacedStation& station) {
  return station.position.head<2>();
}

double cross_mm2(const Vec2& a, const Vec2& b) {
  return a.x() * b.y() - a.y() * b.x();
}

/// Inwards, or outwards.
enum class Turn : std::int8_t { In = 1, Out = -1 };

/// The middle of a run of stations at which the line turns by a corner, and its sharpest turn.
struct Corner {
  std::size_t station;
  double turn_rad;
};

std::vector<Corner> corners_of(const std::vector<PlacedStation>& stations, const ThingConfig& config,
                               double station_mm, Turn turn) {
  const auto from = static_cast<std::size_t>(std::lround(config.from_mm / station_mm));
  const auto to = static_cast<std::size_t>(std::lround(config.to_mm / station_mm));
  const double corner_rad = config.least_corner_deg * k_rad_per_deg;
  const std::size_t count = stations.size();
  const auto at = [&](std::size_t i) { return level(stations[i % count]); };
  std::vector<Corner> corners;
  std::size_t run = 0;
  double sharpest_rad = 0;
  for (std::size_t i = 0; i <= count; ++i) {
    const Vec2 before = at(i + count - from) - at(i + count - to);
    const Vec2 behind = at(i + to) - at(i + from);
    const double left_rad = std::atan2(cross_mm2(before, behind), before.dot(behind));
    const double turn_rad = i < count ? -static_cast<double>(turn) * left_rad : 0;
    if (turn_rad > corner_rad) {
      ++run;
      sharpest_rad = std::max(sharpest_rad, turn_rad);
    } else if (run > 0) {
      corners.push_back({.station = i - 1 - (run - 1) / 2, .turn_rad = sharpest_rad});
      run = 0;
      sharpest_rad = 0;
    }
  }
  return corners;
}

/// A stretch of stations, modulo their number.
struct Stretch {
  std::size_t first, steps;
};

/// How far a stretch leads away from its chord, outwards > 0.
double farthest_mm(const std::vector<PlacedStation>& stations, const Stretch& stretch, Turn turn) {
  const std::size_t count = stations.size();
  const Vec2 foot = level(stations[stretch.first % count]);
  const Vec2 chord = level(stations[(stretch.first + stretch.steps) % count]) - foot;
  double farthest = 0;
  for (std::size_t i = 1; i < stretch.steps; ++i) {
    // Outwards of an anticlockwise line is to its right.
    const double out = cross_mm2(level(stations[(stretch.first + i) % count]) - foot, chord);
    farthest = std::max(farthest, -static_cast<double>(turn) * out / std::max(chord.norm(), 1e-6));
  }
  return farthest;
}

class Doubts {
 public:
  Doubts(double station_mm, std::vector<PlacedStation>& stations, const ThingConfig& config)
      : station_mm_{station_mm},
        stations_{stations},
        config_{config},
        hollow_{corners_of(stations, config, station_mm, Turn::In)} {}

  /// Any two corners: a blunt one may lie between two sharp ones.
  void things() {
    for (const Corner& out : hollow_) {
      for (const Corner& back : hollow_) {
        const Stretch between{.first = out.station, .steps = steps(out, back)};
        if (between.steps == 0 || between.steps > steps_of(config_.longest_mm)) continue;
        const double out_mm = farthest_mm(stations_, between, Turn::Out);
        const auto [blunter_rad, sharper_rad] = std::minmax(out.turn_rad, back.turn_rad);
        if (sharper_rad < sharp_rad()) continue;
        const bool is_pin =
            between.steps <= steps_of(config_.longest_slanted_mm) && out_mm >= config_.least_slanted_mm;
        if (blunter_rad < sharp_rad() && !is_pin) continue;
        doubt(between, out_mm, true);
      }
    }
  }

  void gaps() {
    const std::vector<Corner> rims = corners_of(stations_, config_, station_mm_, Turn::Out);
    for (const Corner& corner : hollow_) {
      if (corner.turn_rad < sharp_rad()) continue;
      for (const Corner& before : rims) {
        for (const Corner& behind : rims) {
          const Stretch between{.first = before.station,
                                .steps = steps(before, corner) + steps(corner, behind)};
          if (between.steps > steps_of(config_.longest_mm)) continue;
          const double in_mm = farthest_mm(stations_, between, Turn::In);
          if (in_mm >= config_.least_slanted_mm) doubt(between, in_mm, false);
        }
      }
    }
  }

 private:
  [[nodiscard]] double sharp_rad() const { return config_.corner_deg * k_rad_per_deg; }
  [[nodiscard]] std::size_t steps_of(double mm) const {
    return static_cast<std::size_t>(std::lround(mm / station_mm_));
  }
  [[nodiscard]] std::size_t steps(const Corner& from, const Corner& to) const {
    return (to.station + stations_.size() - from.station) % stations_.size();
  }

  void doubt(const Stretch& stretch, double off_mm, bool thing) {
    const std::size_t count = stations_.size();
    const std::size_t beside = steps_of(config_.beside_mm);
    for (std::size_t i = 0; i <= stretch.steps + 2 * beside; ++i) {
      PlacedStation& station = stations_[(stretch.first + count - beside + i) % count];
      station.thing_beside = station.thing_beside || thing;
      if (config_.hold >= station.hold) continue;
      station.hold = config_.hold;
      station.other_mm = std::max(station.other_mm, off_mm);
    }
  }

  double station_mm_;
  std::vector<PlacedStation>& stations_;
  const ThingConfig& config_;
  std::vector<Corner> hollow_;
};

}  // namespace

void doubt_things_beside(double station_mm, std::vector<PlacedStation>& stations, const ThingConfig& config) {
  if (static_cast<double>(stations.size()) * station_mm <= 2 * config.longest_mm) return;
  Doubts doubts{station_mm, stations, config};
  doubts.things();
  doubts.gaps();
}

}  // namespace biteline::bite_line
