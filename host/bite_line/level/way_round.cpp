// SPDX-License-Identifier: MIT
#include "host/bite_line/level/way_round.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>

#include "host/bite_line/level/cheapest_way.hpp"
#include "host/bite_line/level/patch.hpp"
#include "host/bite_line/level/rival_ways.hpp"
#include "host/bite_line/level/step_costs.hpp"

namespace biteline::bite_line {

namespace {

/// The middle of the longest stretch of columns that show a crease which holds.
std::optional<std::size_t> surest_col(const Layers& layers) {
  constexpr float k_holds = 0.5F;
  const std::size_t cols = layers.hold.size();
  std::size_t longest = 0;
  std::optional<std::size_t> middle;
  for (std::size_t k = 0, run = 0; k < 2 * cols; ++k) {
    run = layers.line.visible[k % cols] != 0 && layers.hold[k % cols] > k_holds ? run + 1 : 0;
    if (run <= longest) continue;
    longest = run;
    middle = (k - run / 2) % cols;
  }
  return middle;
}

/// Whether the surface on a step's right side turns outwards by much, or ends, within a few millimetres.
bool ends_close_below(const Patch& patch, const Cell& cell, std::size_t step) {
  constexpr double k_rim_rad = 0.5;
  constexpr double k_from_mm = 1.0, k_to_mm = 3.0, k_lever_mm = 1.0;
  const GridStep along = k_grid_steps[step];
  const double cells = 1 / (Patch::k_cell_mm * std::hypot(along.cols, along.rows));
  const auto o_mm = [&](double d) -> std::optional<double> {
    const int col = cell.col + static_cast<int>(std::lround(along.rows * cells * d));
    const int row = cell.row - static_cast<int>(std::lround(along.cols * cells * d));
    if (col < 0 || col >= patch.cols || row < 0 || row >= patch.rows) return std::nullopt;
    if (patch.seen[patch.at(row, col)] == 0) return std::nullopt;
    return static_cast<double>(patch.o_mm[patch.at(row, col)]);
  };
  for (double d = k_from_mm; d <= k_to_mm; d += Patch::k_cell_mm) {
    const std::optional<double> before = o_mm(d - k_lever_mm), here = o_mm(d), behind = o_mm(d + k_lever_mm);
    if (!before || !here || !behind) return true;
    if (std::atan((*here - *before) / k_lever_mm) - std::atan((*behind - *here) / k_lever_mm) > k_rim_rad)
      return true;
  }
  return false;
}

/// Of the way's length that was seen.
double thin_share(const Patch& patch, const Way& way) {
  double seen_mm = 0, thin_mm = 0;
  for (std::size_t i = 1; i < way.cells.size(); ++i) {
    const Cell& at = way.cells[i];
    if (patch.seen[patch.at(at.row, at.col)] == 0) continue;
    const std::size_t step = step_between(way.cells[i - 1], at);
    const auto step_mm = static_cast<double>(Patch::length_mm(k_grid_steps[step]));
    seen_mm += step_mm;
    if (ends_close_below(patch, at, step)) thin_mm += step_mm;
  }
  return seen_mm > 0 ? thin_mm / seen_mm : 0;
}

}  // namespace

Guide way_round(const Side& side, const Layers& layers, const WayRoundConfig& config) {
  const SideGrid& grid = side.field.grid;
  const double turn_mm = side.outline.length_mm();
  const std::optional<std::size_t> col = surest_col(layers);
  if (!col) return {};
  const double s_mm = (static_cast<double>(*col) + 0.5) * grid.col_mm;
  const double top_mm = grid.z_mm(*std::ranges::max_element(layers.line.row)) + config.above_mm;
  // The middle of its first column is where the way begins, that of its last one is a whole turn on.
  const Patch patch = Patch::of(side,
                                {.s_mm = s_mm - Patch::k_cell_mm / 2,
                                 .length_mm = turn_mm + Patch::k_cell_mm,
                                 .z_mm = grid.z_low_mm,
                                 .height_mm = top_mm - grid.z_low_mm},
                                config.sigma_mm);
  const Cell begin = patch.cell({s_mm, grid.z_mm(layers.line.row[*col])});
  StepCostConfig reads{
      .flank_mm = config.flank_mm, .rim_rad = config.rim_rad, .above_to_mm = config.left_above_mm};
  const StepCosts costs = step_costs(patch, reads);
  const Way way = cheapest_way(patch, costs, begin, {.row = begin.row, .col = patch.cols - 1});
  Guide guide;
  const bool thin = thin_share(patch, way) >= config.least_thin_share;
  if (way.cost > (thin ? config.most_thin_cost : config.most_cost) * turn_mm) return guide;
  reads.above_to_mm = 0;
  WayDoubt doubt = doubt_way(patch, costs, step_costs(patch, reads), way, {});
  guide.places = places_of(patch, way);
  while (guide.places.size() > 1 && guide.places.back().x() > s_mm + turn_mm - Patch::k_cell_mm / 2)
    guide.places.pop_back();
  guide.hold = std::move(doubt.hold);
  guide.other_mm = std::move(doubt.other_mm);
  return guide;
}

}  // namespace biteline::bite_line
