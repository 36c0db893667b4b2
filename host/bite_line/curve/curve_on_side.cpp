// SPDX-License-Identifier: MIT
#include "host/bite_line/curve/curve_on_side.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "host/bite_line/curve/crease_looks.hpp"
#include "host/bite_line/curve/curve_costs.hpp"
#include "host/bite_line/curve/curve_rivals.hpp"
#include "host/bite_line/layers/material.hpp"
#include "host/bite_line/path/decide.hpp"

namespace biteline::bite_line {

namespace {

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
    Crease crease = describe(side_.field, {}, on_crest(side_.field, rows, Raster::k_cell_mm), {});
    crease.evidence = evidence_along(ground_, states);
    return std::log(std::max(sure_alone(crease), k_least));
  }

  const Side& side_;
  const CurveGround& ground_;
  std::optional<Materials> materials_;
};

}  // namespace

CurveGround curve_ground(const Side& side) {
  const SideGrid& grid = side.field.grid;
  Raster raster = Raster::of({side.field.places.data(), side.field.places.size()}, side.outline.length_mm(),
                             grid.z_low_mm, grid.rows * grid.row_mm, side.field.points_per_mm2);
  CreaseLooks creases{raster};
  CurveCosts costs = curve_costs(raster, creases, fitted_weights());
  return {.raster = std::move(raster), .costs = std::move(costs)};
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

std::optional<CurveOnSide> curve_on(const Side& side, std::span<const RunLook> looks) {
  constexpr RivalConfig k_rivals{};
  constexpr PosteriorConfig k_posterior{};
  const CurveGround ground = curve_ground(side);
  std::optional<ClosedCurve> best = CurveSearch{ground.costs, {}}.best();
  if (!best) return std::nullopt;
  const auto rivals_of_best = [&] {
    std::vector<CurveRival> rivals = rivals_of(ground.raster, ground.costs, {}, *best, k_rivals);
    const auto goes_round = [&](const CurveRival& rival) { return rival.count == best->states.size(); };
    if (std::ranges::none_of(rivals, goes_round)) return rivals;
    const Wholes wholes{side, looks, ground};
    for (CurveRival& rival : rivals)
      if (goes_round(rival)) rival.as_whole = wholes.log_odds(rival.states, best->states);
    return rivals;
  };
  std::vector<CurveRival> rivals = rivals_of_best();
  // A way all round that costs more, and is the likelier line as a whole.
  const auto log_odds = [&](const CurveRival& rival) { return log_odds_of(rival, *best, k_posterior); };
  const auto likeliest = std::ranges::max_element(rivals, {}, [&](const CurveRival& rival) {
    return rival.count == best->states.size() ? log_odds(rival) : -1e9;
  });
  if (likeliest != rivals.end() && likeliest->count == best->states.size() && log_odds(*likeliest) > 0) {
    best = ClosedCurve{.states = std::move(likeliest->states), .energy = best->energy + likeliest->excess};
    rivals = rivals_of_best();
  }
  std::vector<CurveStation> stations =
      curve_posterior(ground.raster, *best, rivals, k_rivals.same_mm, k_posterior);
  const double evidence = evidence_along(ground, best->states);
  return CurveOnSide{.curve = std::move(*best), .evidence = evidence, .stations = std::move(stations)};
}

}  // namespace biteline::bite_line
