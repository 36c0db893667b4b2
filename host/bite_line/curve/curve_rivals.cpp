// SPDX-License-Identifier: MIT
#include "host/bite_line/curve/curve_rivals.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <utility>

namespace biteline::bite_line {

namespace {

/// The cells beside a curve, each with the nearest of its states.
class Band {
 public:
  Band(const Raster& raster, const ClosedCurve& curve, double reach_mm)
      : raster_{raster},
        near_(raster.size(), k_none),
        off_(raster.size(), std::numeric_limits<float>::max()) {
    const int reach = static_cast<int>(reach_mm / Raster::k_cell_mm);
    for (std::size_t i = 0; i < curve.states.size(); ++i) {
      const CurveState& at = curve.states[i];
      for (int c = -reach; c <= reach; ++c)
        for (int r = std::max(-reach, -at.row); r <= std::min(reach, raster.rows - 1 - at.row); ++r)
          take(raster.at(at.row + r, raster.round_col(at.col + c)), i, static_cast<float>(r * r + c * c));
    }
  }
  [[nodiscard]] bool holds(std::size_t cell) const { return near_[cell] != k_none; }
  /// The curve's state beside a state within the band.
  [[nodiscard]] std::optional<std::size_t> beside(const CurveState& at) const {
    const std::size_t station = near_[raster_.at(at.row, raster_.round_col(at.col))];
    if (station == k_none) return std::nullopt;
    return station;
  }

 private:
  static constexpr std::size_t k_none = std::numeric_limits<std::size_t>::max();

  void take(std::size_t cell, std::size_t station, float off) {
    if (off >= off_[cell]) return;
    off_[cell] = off;
    near_[cell] = station;
  }

  const Raster& raster_;
  std::vector<std::size_t> near_;
  std::vector<float> off_;
};

CurveCosts dearer_beside(const Band& band, const CurveCosts& costs, double per_mm) {
  CurveCosts dearer = costs;
  for (std::size_t cell = 0; cell < dearer.per_mm.size() / k_directions; ++cell)
    if (band.holds(cell))
      for (std::size_t k = 0; k < k_directions; ++k) dearer.of(cell, k) += static_cast<float>(per_mm);
  return dearer;
}

std::vector<Vec2> places_of(const Raster& raster, std::span<const CurveState> states) {
  std::vector<Vec2> places;
  for (const CurveState& at : states) places.push_back(raster.place(at.row, at.col));
  return places;
}

/// `count` states from the `first` on, where they go on behind the last once round, too.
std::vector<CurveState> part_of(const ClosedCurve& curve, std::size_t first, std::size_t count, int cols) {
  const std::size_t n = curve.states.size();
  first %= n;
  std::vector<CurveState> part;
  for (std::size_t i = first; i < first + count; ++i) {
    part.push_back(curve.states[i % n]);
    part.back().col += static_cast<int>(i / n) * cols;
  }
  return part;
}

/// Of states that follow each other, once round.
struct Away {
  std::size_t first, count;
};

template <class IsAway>
std::vector<Away> stretches_away(std::size_t n, IsAway&& is_away) {
  std::size_t begin = 0;
  while (begin < n && is_away(begin)) ++begin;
  if (begin == n) return {{.first = 0, .count = n}};
  std::vector<Away> all;
  for (std::size_t i = begin; i < begin + n; ++i) {
    if (!is_away(i % n)) continue;
    if (i > 0 && is_away((i - 1) % n))
      ++all.back().count;
    else
      all.push_back({.first = i % n, .count = 1});
  }
  return all;
}

std::vector<CurveRival> rivals_within(const Band& band, const Raster& raster, const CurveCosts& costs,
                                      const CurveConfig& search, const ClosedCurve& curve, double per_mm) {
  const CurveCosts dearer = dearer_beside(band, costs, per_mm);
  const std::optional<ClosedCurve> other = CurveSearch{dearer, search}.best();
  if (!other) return {};
  const std::size_t n = other->states.size(), own = curve.states.size();
  const auto beside = [&](std::size_t i) { return band.beside(other->states[i % n]); };
  const auto way_cost = [&](std::size_t first, std::size_t count) {
    return energy_of(part_of(*other, first, count + 1, raster.cols), costs, search);
  };
  const auto own_cost = [&](std::size_t first, std::size_t count) {
    return energy_of(part_of(curve, first, count + 1, raster.cols), costs, search);
  };
  const std::vector<Away> away = stretches_away(n, [&](std::size_t i) { return !beside(i); });
  if (away.empty()) return {};
  const auto rival = [&](std::size_t first, std::size_t count, std::span<const CurveState> way,
                         double excess) {
    return CurveRival{.first = first,
                      .count = count,
                      .places = places_of(raster, way),
                      .length_mm = length_of(part_of(curve, first, count + 1, raster.cols)),
                      .excess = excess};
  };
  const double all_more = way_cost(0, n) - own_cost(0, own);
  if (away.front().count == n) return {rival(0, own, other->states, all_more)};
  std::vector<CurveRival> rivals;
  for (std::size_t k = 0; k < away.size(); ++k) {
    const Away& here = away[k];
    const std::size_t leaves = *beside(here.first + n - 1), returns = *beside(here.first + here.count);
    // Within the band a way leaves the curve and comes back to it: up to half of what lies between two.
    const Away& before = away[(k + away.size() - 1) % away.size()];
    const Away& after = away[(k + 1) % away.size()];
    const std::size_t since = (here.first + n - before.first - before.count) % n;
    const std::size_t until = (after.first + 2 * n - here.first - here.count) % n;
    const std::size_t begin = here.first + n - (since + 1) / 2, end = here.first + n + here.count + until / 2;
    const std::size_t from = *beside(begin), to = *beside(end);
    const double more =
        away.size() == 1 ? all_more : way_cost(begin, end - begin) - own_cost(from, (to + own - from) % own);
    rivals.push_back(rival(leaves, (returns + own - leaves) % own,
                           part_of(*other, here.first + n - 1, here.count + 2, raster.cols), more));
  }
  return rivals;
}

}  // namespace

std::vector<CurveRival> rivals_of(const Raster& raster, const CurveCosts& costs, const CurveConfig& search,
                                  const ClosedCurve& curve, const RivalConfig& config) {
  const Band band{raster, curve, config.same_mm};
  std::vector<CurveRival> all;
  for (const double per_mm : config.per_mm) {
    const std::vector<CurveRival> rivals = rivals_within(band, raster, costs, search, curve, per_mm);
    if (rivals.empty()) break;
    all.insert(all.end(), rivals.begin(), rivals.end());
  }
  return all;
}

}  // namespace biteline::bite_line
