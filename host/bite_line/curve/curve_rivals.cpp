// SPDX-License-Identifier: MIT
#include "host/bite_line/curve/curve_rivals.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <utility>

#include "host/bite_line/curve/curve_look.hpp"

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

/// So much more some cells cost.
class DearerCells {
 public:
  DearerCells(const Raster& raster, double reach_mm, double per_mm)
      : raster_{raster},
        reach_{static_cast<int>(reach_mm / Raster::k_cell_mm)},
        per_mm_{static_cast<float>(per_mm)},
        dearer_(raster.size()) {
    std::ranges::fill(dearer_, 0.0F);
  }

  /// What lies beside these states.
  void raise(std::span<const CurveState> states) {
    for (const CurveState& at : states) {
      for (int col = at.col - reach_; col <= at.col + reach_; ++col) {
        for (int row = std::max(0, at.row - reach_); row <= std::min(raster_.rows - 1, at.row + reach_);
             ++row)
          dearer_[raster_.at(row, raster_.round_col(col))] = per_mm_;
      }
    }
  }
  [[nodiscard]] bool is_dearer(const CurveState& at) const {
    return dearer_[raster_.at(at.row, raster_.round_col(at.col))] != 0;
  }
  [[nodiscard]] std::span<const float> per_cell() const { return dearer_; }

 private:
  const Raster& raster_;
  int reach_;
  float per_mm_;
  PooledVector<float> dearer_;
};

std::vector<Vec2> places_of(const Raster& raster, std::span<const CurveState> states) {
  std::vector<Vec2> places;
  for (const CurveState& at : states) places.push_back(raster.place(at.row, at.col));
  return places;
}

double mean_height_mm(std::span<const Vec2> places) {
  double sum = 0;
  for (const Vec2& place : places) sum += place.y();
  return sum / static_cast<double>(places.size());
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

/// Where `other` leads away from `curve`.
std::vector<CurveRival> ways_of(const ClosedCurve& other, const Band& band, const Raster& raster,
                                const CurveCosts& costs, const CurveConfig& search,
                                const ClosedCurve& curve) {
  const std::size_t n = other.states.size(), own = curve.states.size();
  const auto beside = [&](std::size_t i) { return band.beside(other.states[i % n]); };
  const auto way_cost = [&](std::size_t first, std::size_t count) {
    return energy_of(part_of(other, first, count + 1, raster.cols), costs, search);
  };
  const auto own_cost = [&](std::size_t first, std::size_t count) {
    return energy_of(part_of(curve, first, count + 1, raster.cols), costs, search);
  };
  const std::vector<Away> away = stretches_away(n, [&](std::size_t i) { return !beside(i); });
  if (away.empty()) return {};
  const auto found = [&](std::size_t first, std::size_t count, std::vector<CurveState> way, double excess) {
    std::vector<Vec2> places = places_of(raster, way);
    const std::vector<CurveState> stretch = part_of(curve, first, count + 1, raster.cols);
    const double above_mm = mean_height_mm(places) - mean_height_mm(places_of(raster, stretch));
    return CurveRival{.first = first,
                      .count = count,
                      .states = std::move(way),
                      .places = std::move(places),
                      .length_mm = length_of(stretch),
                      .above_mm = above_mm,
                      .excess = excess};
  };
  const double all_more = way_cost(0, n) - own_cost(0, own);
  std::vector<CurveRival> ways;
  // Both may be one where a side shows hardly anything else, as behind a high heel: it is another curve
  // still.
  if (2 * std::ranges::max(away, {}, &Away::count).count > n)
    ways.push_back(found(0, own, other.states, all_more));
  if (away.front().count == n) return ways;
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
    ways.push_back(found(leaves, (returns + own - leaves) % own,
                         part_of(other, here.first + n - 1, here.count + 2, raster.cols), more));
  }
  return ways;
}

/// What rivals look like, beside their stretches of a curve.
class Looker {
 public:
  Looker(const CurveGround& ground, const ClosedCurve& curve)
      : ground_{ground}, own_{places_along(ground, curve.states)} {}

  void look_at(CurveRival& rival) const {
    const std::vector<SeenPlace> way = seen_of(places_along(ground_, rival.states), 0, rival.states.size());
    const std::vector<SeenPlace> stretch = seen_of(own_, rival.first, rival.count);
    rival.seen = 3 * way.size() > rival.states.size() && 3 * stretch.size() > rival.count;
    if (!rival.seen) return;
    const std::vector<SeenPlace>& upper = rival.above_mm > 0 ? way : stretch;
    rival.two_surfaces = mean_of(upper, CreaseSign::TwoSurfaces);
    rival.uneven = uneven_along(upper);
    rival.own_per_mm = mean_per_mm(stretch);
    // The curve leaves the line, and comes back to it, before the way is well beside it.
    const std::size_t ends = std::min(k_leaving, (own_.size() - rival.count) / 2);
    rival.faintest_per_mm =
        faintest_of(seen_of(own_, rival.first + own_.size() - ends, rival.count + 2 * ends));
  }

 private:
  static constexpr std::size_t k_leaving = 6;  // states: 4.5 mm, twice RivalConfig::same_mm

  const CurveGround& ground_;
  PlacesAlong own_;
};

/// Per column, the lowest row that is well above the curve.
std::vector<int> rows_above(const Raster& raster, const ClosedCurve& curve, double same_mm) {
  const int beyond = static_cast<int>(same_mm / Raster::k_cell_mm) + 1;
  std::vector<int> first(static_cast<std::size_t>(raster.cols), 0);
  for (const CurveState& at : curve.states) {
    for (int col = at.col - 1; col <= at.col + 1; ++col) {  // no step is longer
      int& row = first[static_cast<std::size_t>(raster.round_col(col))];
      row = std::max(row, at.row + beyond);
    }
  }
  return first;
}

}  // namespace

std::optional<CurveRival> way_above(const CurveGround& ground, const CurveConfig& search,
                                    const ClosedCurve& curve, const RivalConfig& config) {
  constexpr float k_barred = 100;
  const std::vector<int> first = rows_above(ground.raster, curve, config.same_mm);
  const CurveCosts& costs = ground.costs;
  PooledVector<float> barred(ground.raster.size());
  double sum = 0;  // a way costs hardly less: it passes all columns but those that a long step skips
  for (int col = 0; col < costs.cols; ++col) {
    float least = k_barred;
    for (int row = 0; row < costs.rows; ++row) {
      const std::size_t cell = costs.at(row, col);
      const bool above = row >= first[static_cast<std::size_t>(col)];
      barred[cell] = above ? 0 : k_barred;
      if (above) least = std::min(least, costs.least(cell));
    }
    sum += ground.raster.col_mm * static_cast<double>(least);
  }
  const double limit = config.above_per_mm * length_of(curve.states);
  if (sum > limit) return std::nullopt;
  std::optional<ClosedCurve> other = CurveSearch{costs, search, barred}.best(limit);
  if (!other) return std::nullopt;
  CurveRival rival{.first = 0,
                   .count = curve.states.size(),
                   .places = places_of(ground.raster, other->states),
                   .length_mm = length_of(curve.states),
                   .excess = other->energy - curve.energy};
  rival.above_mm = mean_height_mm(rival.places) - mean_height_mm(places_of(ground.raster, curve.states));
  rival.states = std::move(other->states);
  Looker{ground, curve}.look_at(rival);
  return rival;
}

std::vector<CurveRival> rivals_of(const CurveGround& ground, const CurveConfig& search,
                                  const ClosedCurve& curve, std::optional<CurveRival> above,
                                  const RivalConfig& config) {
  const Raster& raster = ground.raster;
  const CurveCosts& costs = ground.costs;
  const Band band{raster, curve, config.same_mm};
  const std::vector<CurveState> once_round = part_of(curve, 0, curve.states.size() + 1, raster.cols);
  const double more_per_mm = config.per_mm + curve.energy / length_of(curve.states);
  DearerCells dearer{raster, config.same_mm, more_per_mm};
  dearer.raise(once_round);
  const double own_cost = energy_of(once_round, costs, search) + more_per_mm * length_of(once_round);
  std::vector<CurveRival> rivals;
  for (int i = 0; i < config.searches; ++i) {
    const std::optional<ClosedCurve> other = CurveSearch{costs, search, dearer.per_cell()}.best(own_cost);
    if (!other) break;
    std::vector<CurveRival> ways = ways_of(*other, band, raster, costs, search, curve);
    std::erase_if(ways, [&](const CurveRival& way) {
      return std::ranges::all_of(way.states, [&](const CurveState& at) { return dearer.is_dearer(at); });
    });
    if (ways.empty()) break;
    for (CurveRival& way : ways) {
      dearer.raise(way.states);
      rivals.push_back(std::move(way));
    }
  }
  const Looker looker{ground, curve};
  for (CurveRival& rival : rivals) looker.look_at(rival);
  const auto is_known = [&](const CurveState& at) { return dearer.is_dearer(at); };
  if (above && !std::ranges::all_of(above->states, is_known)) rivals.push_back(*std::move(above));
  return rivals;
}

}  // namespace biteline::bite_line
