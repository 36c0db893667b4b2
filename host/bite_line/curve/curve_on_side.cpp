// SPDX-License-Identifier: MIT
#include "host/bite_line/curve/curve_on_side.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "host/bite_line/curve/curve_ground.hpp"
#include "host/bite_line/curve/curve_rivals.hpp"
#include "host/bite_line/curve/material.hpp"
#include "host/bite_line/path/decide.hpp"

namespace biteline::bite_line {

namespace {

constexpr RivalConfig k_rivals{};
constexpr PosteriorConfig k_posterior{};

double evidence_along(const CurveGround& ground, std::span<const CurveState> states) {
  double evidence = 0;
  for (const CurveState& at : states) {
    const std::size_t cell = ground.costs.at(at.row, ground.raster.round_col(at.col));
    evidence += std::exp(-static_cast<double>(ground.costs.of(cell, at.direction)));
  }
  return evidence / static_cast<double>(states.size());
}

/// Curves all the way round, compared as wholes.
class Wholes {
 public:
  Wholes(const Side& side, std::span<const RunLook> looks, const CurveGround& ground)
      : side_{side}, ground_{ground}, materials_{Materials::of(side.shoe, side.field, looks)} {}

  /// Of the rival against the curve: by the gates that a line must pass, and by where the material changes.
  [[nodiscard]] double log_odds(std::span<const CurveState> rival, std::span<const CurveState> curve) const {
    // Two colours are on many soles and one on many shoes: a likelihood ratio of at most 10.
    constexpr double k_by_material = 2.3;
    const std::vector<int> rival_rows = rows(rival), own_rows = rows(curve);
    const double favours = materials_ ? materials_->favours(own_rows, rival_rows) : 0;
    return log_sure(rival, rival_rows) - log_sure(curve, own_rows) - k_by_material * favours;
  }

 private:
  [[nodiscard]] std::vector<int> rows(std::span<const CurveState> states) const {
    std::vector<Vec2> places;
    for (const CurveState& at : states) places.push_back(ground_.raster.place(at.row, at.col));
    return rows_along(places, side_.field.grid, side_.outline.length_mm());
  }
  [[nodiscard]] double log_sure(std::span<const CurveState> states, std::span<const int> rows) const {
    constexpr double k_least = 1e-5;  // what a gate refuses is hardly a line
    Crease crease = describe(side_.field, on_crest(side_.field, rows, Raster::k_cell_mm), {});
    crease.evidence = evidence_along(ground_, states);
    return std::log(std::max(sure_alone(crease), k_least));
  }

  const Side& side_;
  const CurveGround& ground_;
  std::optional<Materials> materials_;
};

/// What a curve usually shows, where both flanks were seen.
CreaseSigns usual_along(const CurveGround& ground, std::span<const CurveState> states) {
  std::vector<CreaseSigns> seen;
  for (const CurveState& at : states) {
    const CreaseSigns signs = ground.looks.alone(at.row, ground.raster.round_col(at.col), at.direction);
    if (signs[static_cast<std::size_t>(CreaseSign::FlanksSeen)] != 0) seen.push_back(signs);
  }
  return medians_of(seen);
}

struct Highest {
  ClosedCurve curve;
  std::optional<CurveRival> above;  ///< a way all round above it, less likely
};

/// The curve, or one all round above it that is the likelier line, and so on.
Highest highest_from(const CurveGround& ground, const CurveConfig& search, ClosedCurve curve,
                     const AsWhole& as_whole) {
  while (std::optional<CurveRival> above = way_above(ground, search, curve, k_rivals)) {
    above->as_whole = as_whole(above->states, curve.states);
    if (log_odds_of(*above, curve, k_posterior) <= 0) return {std::move(curve), std::move(above)};
    curve = {.states = std::move(above->states), .energy = curve.energy + above->excess};
  }
  return {std::move(curve), std::nullopt};
}

/// Of rivals all round, the likeliest one that is above the curve and likelier than it.
const CurveRival* likelier_above(std::span<const CurveRival> rivals, const ClosedCurve& curve) {
  const CurveRival* likeliest = nullptr;
  double most = 0;
  for (const CurveRival& rival : rivals) {
    if (rival.count != curve.states.size() || !rival.seen || !(rival.above_mm > 0)) continue;
    const double log_odds = log_odds_of(rival, curve, k_posterior);
    if (log_odds <= most) continue;
    most = log_odds;
    likeliest = &rival;
  }
  return likeliest;
}

}  // namespace

CurveGround curve_ground(const Side& side) {
  const SideGrid& grid = side.field.grid;
  return {Raster::of({side.field.places.data(), side.field.places.size()}, side.outline.length_mm(),
                     grid.z_low_mm, grid.rows * grid.row_mm, side.field.points_per_mm2),
          fitted_weights()};
}

std::vector<int> rows_along(std::span<const Vec2> places, const SideGrid& grid, double turn_mm) {
  BITELINE_EXPECTS(!places.empty());
  constexpr int k_none = -1;
  std::vector<int> rows(static_cast<std::size_t>(grid.cols), k_none);
  const auto row_of = [&](const Vec2& place) {
    return std::clamp(static_cast<int>(std::lround((place.y() - grid.z_low_mm) / grid.row_mm - 0.5)), 0,
                      grid.rows - 1);
  };
  for (const Vec2& place : places) {
    const double s_mm = place.x() - turn_mm * std::floor(place.x() / turn_mm);
    rows[std::min(static_cast<std::size_t>(s_mm / grid.col_mm), rows.size() - 1)] = row_of(place);
  }
  int last = row_of(places.back());
  for (int& row : rows) {
    if (row == k_none) row = last;
    last = row;
  }
  return rows;
}

std::optional<CurveAndRivals> best_curve(CurveGround& ground, const CurveConfig& search,
                                         const AsWhole& as_whole) {
  std::optional<ClosedCurve> best = CurveSearch{ground.costs, search}.best();
  if (!best) return std::nullopt;
  Highest first = highest_from(ground, search, *std::move(best), as_whole);
  ground.compare_with(usual_along(ground, first.curve.states));
  best = CurveSearch{ground.costs, search}.best();
  if (!best) return std::nullopt;
  ClosedCurve curve = *std::move(best);
  std::vector<CurveRival> rivals;
  // Each is higher than the one before: this ends.
  for (const CurveRival* upper = nullptr;;) {
    Highest highest = highest_from(ground, search, std::move(curve), as_whole);
    curve = std::move(highest.curve);
    rivals = rivals_of(ground, search, curve, std::move(highest.above), k_rivals);
    for (CurveRival& rival : rivals)
      if (rival.count == curve.states.size()) rival.as_whole = as_whole(rival.states, curve.states);
    upper = likelier_above(rivals, curve);
    if (upper == nullptr) break;
    curve = {.states = upper->states, .energy = curve.energy + upper->excess};
  }
  // That a way above does not look as the curve itself usually does is no reason to forget it.
  const auto leads_above = [&](const CurveRival& rival) {
    return leads_all_round(rival, curve) && rival.above_mm > 0;
  };
  if (first.above && std::ranges::none_of(rivals, leads_above)) {
    first.above->count = curve.states.size();
    rivals.push_back(*std::move(first.above));
  }
  CurveLook look = look_of(places_along(ground, curve.states));
  return CurveAndRivals{.curve = std::move(curve), .rivals = std::move(rivals), .look = std::move(look)};
}

std::optional<CurveOnSide> curve_on(const Side& side, std::span<const RunLook> looks) {
  CurveGround ground = curve_ground(side);
  std::optional<Wholes> wholes;
  std::optional<CurveAndRivals> best = best_curve(ground, {}, [&](auto rival, auto curve) {
    if (!wholes) wholes.emplace(side, looks, ground);
    return wholes->log_odds(rival, curve);
  });
  if (!best) return std::nullopt;
  std::vector<CurveStation> stations =
      curve_posterior(ground.raster, best->curve, best->rivals, best->look, k_rivals.same_mm, k_posterior);
  const double evidence = evidence_along(ground, best->curve.states);
  return CurveOnSide{.curve = std::move(best->curve), .evidence = evidence, .stations = std::move(stations)};
}

}  // namespace biteline::bite_line
