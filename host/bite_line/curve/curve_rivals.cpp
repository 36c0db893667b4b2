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

/// The costs when some cells are dearer.
class DearerCosts {
 public:
  DearerCosts(const Raster& raster, const CurveCosts& costs, double reach_mm, double per_mm)
      : raster_{raster},
        costs_{costs},
        reach_{static_cast<int>(reach_mm / Raster::k_cell_mm)},
        per_mm_{static_cast<float>(per_mm)},
        dearer_(raster.size(), 0) {}

  /// What lies beside these states.
  void raise(std::span<const CurveState> states) {
    for (const CurveState& at : states) {
      for (int col = at.col - reach_; col <= at.col + reach_; ++col) {
        for (int row = std::max(0, at.row - reach_); row <= std::min(raster_.rows - 1, at.row + reach_);
             ++row)
          raise(raster_.at(row, raster_.round_col(col)));
      }
    }
  }
  [[nodiscard]] bool is_dearer(const CurveState& at) const {
    return dearer_[raster_.at(at.row, raster_.round_col(at.col))] != 0;
  }
  [[nodiscard]] const CurveCosts& costs() const { return costs_; }

 private:
  void raise(std::size_t cell) {
    if (std::exchange(dearer_[cell], std::uint8_t{1}) != 0) return;
    for (std::size_t k = 0; k < k_directions; ++k) costs_.of(cell, k) += per_mm_;
  }

  const Raster& raster_;
  CurveCosts costs_;
  int reach_;
  float per_mm_;
  std::vector<std::uint8_t> dearer_;
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
  if (away.front().count == n) return {found(0, own, other.states, all_more)};
  std::vector<CurveRival> ways;
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

/// A curve's place whose surface was seen.
struct SeenPlace {
  CreaseSigns signs;
  double per_mm;
  double mm;  ///< to the next place
};

double mean_of(std::span<const SeenPlace> places, CreaseSign sign) {
  double sum = 0;
  for (const SeenPlace& place : places)
    sum += static_cast<double>(place.signs[static_cast<std::size_t>(sign)]);
  return sum / static_cast<double>(std::max<std::size_t>(places.size(), 1));
}

double mean_per_mm(std::span<const SeenPlace> places) {
  double sum = 0;
  for (const SeenPlace& place : places) sum += place.per_mm;
  return sum / static_cast<double>(std::max<std::size_t>(places.size(), 1));
}

/// Of means over some 12 mm: their standard deviation.
double uneven_along(std::span<const SeenPlace> places) {
  constexpr std::size_t k_run = 17;
  if (places.size() < k_run) return 0;
  const double mean = mean_per_mm(places);
  double squares = 0;
  for (std::size_t i = 0; i + k_run <= places.size(); ++i) {
    const double off = mean_per_mm(places.subspan(i, k_run)) - mean;
    squares += off * off;
  }
  return std::sqrt(squares / static_cast<double>(places.size() - k_run + 1));
}

/// Over 3 mm: the most of it that looks like no line.
double faintest_of(std::span<const SeenPlace> places) {
  constexpr double k_run_mm = 3;
  double most = 0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    double cost = 0, mm = 0;
    for (std::size_t j = i; j < places.size() && mm < k_run_mm; ++j) {
      cost += places[j].per_mm * places[j].mm;
      mm += places[j].mm;
    }
    if (mm >= k_run_mm || i == 0) most = std::max(most, cost / mm);
  }
  return most;
}

/// What rivals look like, beside their stretches of a curve.
class Looker {
 public:
  Looker(const CurveGround& ground, const ClosedCurve& curve) : ground_{ground} {
    for (const CurveState& at : curve.states) own_.push_back(place_at(at));
  }

  void look_at(CurveRival& rival) const {
    std::vector<SeenPlace> way;
    for (const CurveState& at : rival.states)
      if (const std::optional<SeenPlace> place = place_at(at)) way.push_back(*place);
    const std::vector<SeenPlace> stretch = own_part(rival.first, rival.count);
    rival.seen = 3 * way.size() > rival.states.size() && 3 * stretch.size() > rival.count;
    if (!rival.seen) return;
    const std::vector<SeenPlace>& upper = rival.above_mm > 0 ? way : stretch;
    rival.two_surfaces = mean_of(upper, CreaseSign::TwoSurfaces);
    rival.uneven = uneven_along(upper);
    rival.own_per_mm = mean_per_mm(stretch);
    // The curve leaves the line, and comes back to it, before the way is well beside it.
    const std::size_t ends = std::min(k_leaving, (own_.size() - rival.count) / 2);
    rival.faintest_per_mm = faintest_of(own_part(rival.first + own_.size() - ends, rival.count + 2 * ends));
  }

 private:
  static constexpr std::size_t k_leaving = 6;  // states: 4.5 mm, twice RivalConfig::same_mm

  /// What was seen of so many states of the curve.
  [[nodiscard]] std::vector<SeenPlace> own_part(std::size_t first, std::size_t count) const {
    std::vector<SeenPlace> part;
    for (std::size_t i = first; i < first + count; ++i)
      if (const std::optional<SeenPlace>& place = own_[i % own_.size()]) part.push_back(*place);
    return part;
  }

  [[nodiscard]] std::optional<SeenPlace> place_at(const CurveState& at) const {
    const int col = ground_.raster.round_col(at.col);
    const std::size_t cell = ground_.raster.at(at.row, col);
    if (ground_.raster.seen[cell] == 0) return std::nullopt;
    return SeenPlace{.signs = ground_.looks.all(at.row, col, at.direction),
                     .per_mm = static_cast<double>(ground_.costs.of(cell, at.direction)),
                     .mm = k_cell_steps[at.direction].length() * Raster::k_cell_mm};
  }

  const CurveGround& ground_;
  std::vector<std::optional<SeenPlace>> own_;
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
  CurveCosts above = ground.costs;
  double least = 0;  // a way costs hardly less: it passes all columns but those that a long step skips
  for (int col = 0; col < above.cols; ++col) {
    const std::size_t from = above.at(0, col) * k_directions;
    const auto rows = static_cast<std::size_t>(std::min(first[static_cast<std::size_t>(col)], above.rows));
    const auto begin = above.per_mm.begin() + static_cast<std::ptrdiff_t>(from);
    const auto open = begin + static_cast<std::ptrdiff_t>(rows * k_directions);
    const auto end = begin + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(above.rows) * k_directions);
    std::fill(begin, open, k_barred);
    least +=
        ground.raster.col_mm * static_cast<double>(open == end ? k_barred : *std::min_element(open, end));
  }
  const double limit = config.above_per_mm * length_of(curve.states);
  if (least > limit) return std::nullopt;
  std::optional<ClosedCurve> other = CurveSearch{above, search}.best(limit);
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
                                  const ClosedCurve& curve, const RivalConfig& config) {
  const Raster& raster = ground.raster;
  const CurveCosts& costs = ground.costs;
  const Band band{raster, curve, config.same_mm};
  const std::vector<CurveState> once_round = part_of(curve, 0, curve.states.size() + 1, raster.cols);
  const double own_per_mm = curve.energy / length_of(curve.states);
  DearerCosts dearer{raster, costs, config.same_mm, config.per_mm + own_per_mm};
  dearer.raise(once_round);
  const double own_cost = energy_of(once_round, dearer.costs(), search);
  std::vector<CurveRival> rivals;
  for (int i = 0; i < config.searches; ++i) {
    const std::optional<ClosedCurve> other = CurveSearch{dearer.costs(), search}.best(own_cost);
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
  std::optional<CurveRival> above = way_above(ground, search, curve, config);
  const auto is_known = [&](const CurveState& at) { return dearer.is_dearer(at); };
  if (above && !std::ranges::all_of(above->states, is_known)) rivals.push_back(*std::move(above));
  return rivals;
}

}  // namespace biteline::bite_line
