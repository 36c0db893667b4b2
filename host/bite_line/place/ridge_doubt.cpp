// SPDX-License-Identifier: MIT
#include "host/bite_line/place/ridge_doubt.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

#include "host/bite_line/place/point_spread.hpp"
#include "host/cloud/closed_line.hpp"
#include "host/geometry/bridge.hpp"
#include "host/geometry/closed_curve.hpp"
#include "host/geometry/logistic.hpp"
#include "host/geometry/robust.hpp"

namespace biteline::bite_line {

namespace {

/// The least value within `steps` to both sides, closed.
std::vector<double> least_about(std::span<const double> values, std::size_t steps) {
  const std::size_t count = values.size();
  std::vector<double> least(values.begin(), values.end());
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t k = 1; k <= std::min(steps, count - 1); ++k)
      least[i] = std::min({least[i], values[(i + k) % count], values[(i + count - k) % count]});
  }
  return least;
}

}  // namespace

void doubt_ridge(const Ridge& ridge, double steps, std::vector<PlacedStation>& stations) {
  constexpr double k_as_sharp = 1.0;
  constexpr double k_soft = 0.05;
  constexpr double k_most_times = 2;
  constexpr double k_fewest_seen_share = 0.25;
  const std::size_t count = stations.size();
  const auto half = std::min(static_cast<std::size_t>(steps / 2), (count - 1) / 2);
  std::vector<double> times(count, 0.0), away(count, 0.0), hold(count);
  for (std::size_t i = 0; i < count; ++i) {
    if (ridge.visible[i] == 0) continue;
    times[i] = std::min(ridge.other_k_per_mm[i] / std::max(ridge.k_per_mm[i], 1e-6), k_most_times);
    away[i] = times[i] * ridge.other_mm[i];
  }
  // A section that was not seen says nothing of hollows.  Where hardly one was, the bridge tells the doubt.
  const double fewest = k_fewest_seen_share * static_cast<double>(2 * half + 1);
  std::vector<double> about;
  for (std::size_t i = 0; i < count; ++i) {
    about.clear();
    for (std::size_t k = count - half; k <= count + half; ++k) {
      if (ridge.visible[(i + k) % count] != 0) about.push_back(times[(i + k) % count]);
    }
    const bool told = static_cast<double>(about.size()) >= fewest;
    const double most = told ? geometry::median_of(std::span<double>{about}) : 0;
    hold[i] = geometry::logistic((k_as_sharp - most) / k_soft);
  }
  hold = least_about(hold, half / 2);
  times = geometry::running_mean(times, steps);
  away = geometry::running_mean(away, steps);
  for (std::size_t i = 0; i < count; ++i) {
    if (hold[i] >= stations[i].hold) continue;
    stations[i].hold = hold[i];
    stations[i].other_mm = away[i] / std::max(times[i], 1e-6);
  }
}

void doubt_bridges(std::span<const std::uint8_t> known, std::vector<PlacedStation>& stations) {
  constexpr double k_unsure = 0.5;
  const std::size_t count = stations.size();
  for (const geometry::Gap& gap : geometry::gaps_of(known)) {
    const PlacedStation& first = stations[gap.first];
    const PlacedStation& last = stations[(gap.first + gap.steps) % count];
    for (std::size_t k = 1; k < gap.steps; ++k) {
      PlacedStation& station = stations[(gap.first + k) % count];
      const double share = static_cast<double>(k) / static_cast<double>(gap.steps);
      const auto lean_on = [&](const PlacedStation& end, double weight) {
        const double other_mm = weight * end.other_mm;
        if (end.hold >= std::min(station.hold, k_unsure) || other_mm <= cloud::k_right_mm) return;
        station.hold = end.hold;
        station.other_mm = std::max(station.other_mm, other_mm);
      };
      lean_on(first, 1 - share);
      lean_on(last, share);
    }
  }
}

}  // namespace biteline::bite_line
