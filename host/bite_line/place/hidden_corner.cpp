// SPDX-License-Identifier: MIT
#include "host/bite_line/place/hidden_corner.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "host/bite_line/place/gap_bridge.hpp"
#include "host/geometry/bridge.hpp"

namespace biteline::bite_line {

void doubt_hidden_corners(std::span<const Vec2> place, double turn_mm, PlacedLine& placed) {
  constexpr double k_curve = 0.34, k_corner = 0.5;  // sines of 20 and 30 degrees
  if (placed.points.empty()) return;
  const std::size_t count = placed.points.size();
  const double station_mm = placed.length_mm / static_cast<double>(count);
  const auto lever = static_cast<std::size_t>(std::lround(geometry::k_end_lever_mm / station_mm));
  const auto at = [&](std::size_t i) {
    const std::size_t turns = i / count;
    return Vec3{place[i % count].x() + turn_mm * static_cast<double>(turns), place[i % count].y(), 0};
  };
  const auto end_of = [&](std::size_t end, std::size_t near, std::size_t far) {
    return geometry::CurveEnd{at(end), at(near), at(far)}.direction().normalized();
  };
  std::vector<std::uint8_t> known;
  for (const PlacedStation& station : placed.points) known.push_back(station.to_visible_mm > 0 ? 0 : 1);
  for (const geometry::Gap& gap : geometry::gaps_of(known)) {
    if (!is_long(gap, station_mm)) continue;
    const std::size_t first = gap.first + count;  // a turn on: there is a place before it
    const std::size_t end = first + gap.steps;
    const Vec3 chord = at(end) - at(first);
    const Vec3 before = end_of(first, first - lever, first - 2 * lever);
    const Vec3 after = -end_of(end, end + lever, end + 2 * lever);
    const auto off_chord_mm = [&](const Vec3& way) {
      return way.dot(chord) > 0 ? way.cross(chord).norm() : chord.norm();
    };
    const double before_mm = off_chord_mm(before), after_mm = off_chord_mm(after);
    const double climb =
        std::max({std::abs(before.y()), std::abs(after.y()), std::abs(chord.y()) / chord.norm()});
    const double upright = std::clamp((climb - k_curve) / (k_corner - k_curve), 0.0, 1.0);
    for (std::size_t k = 1; k < gap.steps; ++k) {
      PlacedStation& station = placed.points[(first + k) % count];
      const double share = static_cast<double>(k) / static_cast<double>(gap.steps);
      const double away_mm =
          std::min(station.to_visible_mm, std::max(share * before_mm, (1 - share) * after_mm));
      station.hidden_up_mm = upright * away_mm / 2;
    }
  }
}

}  // namespace biteline::bite_line
