// SPDX-License-Identifier: MIT
#include "host/bite_line/place/bare_doubt.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "host/geometry/bridge.hpp"
#include "host/geometry/robust.hpp"

namespace biteline::bite_line {

namespace {

constexpr double k_bare_mm = 16.0;
constexpr double k_bare_doubt = 1.1;

/// Where the line's crease is at least half as sharp as it usually is, and not in a stray section or two.
std::vector<std::uint8_t> is_sharp(const Ridge& ridge, double station_mm) {
  constexpr double k_least_share = 0.5;
  constexpr double k_island_mm = 3.0;
  std::vector<double> seen;
  for (std::size_t i = 0; i < ridge.visible.size(); ++i) {
    if (ridge.visible[i] != 0) seen.push_back(ridge.k_per_mm[i]);
  }
  std::vector<std::uint8_t> sharp(ridge.visible.size(), 0);
  if (seen.empty()) return sharp;
  const double usual = geometry::median_of(std::span<double>{seen});
  for (std::size_t i = 0; i < sharp.size(); ++i)
    sharp[i] = ridge.visible[i] != 0 && ridge.k_per_mm[i] >= k_least_share * usual ? 1 : 0;
  geometry::drop_islands(sharp, station_mm, k_island_mm);
  return sharp;
}

void doubt(PlacedStation& station) {
  station.doubt = std::max(station.doubt, k_bare_doubt);
  station.untried = true;
}

}  // namespace

void doubt_bare(std::span<const std::uint8_t> bare, const Ridge& ridge, double station_mm,
                double most_fade_mm, std::vector<PlacedStation>& stations) {
  const std::size_t count = stations.size();
  std::vector<std::uint8_t> shows;
  for (const std::uint8_t flag : bare) shows.push_back(flag == 0 ? 1 : 0);
  const std::vector<std::uint8_t> sharp = is_sharp(ridge, station_mm);
  const auto most_fade = std::min(static_cast<std::size_t>(std::lround(most_fade_mm / station_mm)), count);
  const auto doubt_fading = [&](std::size_t from, std::size_t step) {
    for (std::size_t k = 0; k < most_fade; ++k) {
      const std::size_t at = (from + k * step) % count;
      if (sharp[at] != 0) return;
      doubt(stations[at]);
    }
  };
  for (const geometry::Gap& gap : geometry::gaps_of(shows)) {
    if (static_cast<double>(gap.steps) * station_mm < k_bare_mm) continue;
    for (std::size_t k = 1; k < gap.steps; ++k) doubt(stations[(gap.first + k) % count]);
    doubt_fading(gap.first, count - 1);
    doubt_fading(gap.first + gap.steps, 1);
  }
}

}  // namespace biteline::bite_line
