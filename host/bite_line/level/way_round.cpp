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

/// Once round the side from a place on.
class Round {
 public:
  Round(const Side& side, const Layers& layers, const WayRoundConfig& config, const Vec2& begin)
      : patch_{Patch::of(side, window(side, layers, config, begin), config.sigma_mm)},
        looks_{look_at_steps(patch_, {.flank_mm = config.flank_mm, .rim_rad = config.rim_rad})},
        costs_{step_costs(patch_, looks_, config.left_above_mm)},
        bare_costs_{step_costs(patch_, looks_, 0)} {
    const Cell from = patch_.cell(begin);
    way_ = cheapest_way(patch_, costs_, from, {.row = from.row, .col = patch_.cols - 1});
  }

  /// Whether it begins and ends on a plain crease.
  [[nodiscard]] bool begins_plain() const {
    const auto beside = static_cast<std::size_t>(std::lround(k_beside_mm / Patch::k_cell_mm));
    if (way_.cells.size() <= 2 * beside) return false;
    double cost = 0;
    for (std::size_t i = 1; i <= beside; ++i)
      cost += cost_at(bare_costs_, i) + cost_at(bare_costs_, way_.cells.size() - i);
    return cost <= 2 * static_cast<double>(beside) * k_plain_cost;
  }

  /// The middle of the way's longest stretch on a plain crease.
  [[nodiscard]] Vec2 plainest_place() const {
    std::size_t middle = 0;
    for (std::size_t i = 1, run = 0, longest = 0; i < way_.cells.size(); ++i) {
      run = cost_at(costs_, i) <= k_plain_cost ? run + 1 : 0;
      if (run <= longest) continue;
      longest = run;
      middle = i - run / 2;
    }
    return patch_.place(way_.cells[middle].row, way_.cells[middle].col);
  }

  [[nodiscard]] Guide guide(const WayRoundConfig& config, double turn_mm) const {
    Guide guide;
    const bool thin = thin_share(patch_, way_) >= config.least_thin_share;
    if (way_.cost > (thin ? config.most_thin_cost : config.most_cost) * turn_mm) return guide;
    WayDoubt doubt = doubt_way(patch_, costs_, bare_costs_, way_, {});
    guide.places = places_of(patch_, way_);
    const double begin_mm = guide.places.front().x();
    while (guide.places.size() > 1 && guide.places.back().x() > begin_mm + turn_mm - Patch::k_cell_mm / 2)
      guide.places.pop_back();
    guide.hold = std::move(doubt.hold);
    guide.other_mm = std::move(doubt.other_mm);
    return guide;
  }

 private:
  static constexpr double k_plain_cost = 0.15;
  static constexpr double k_beside_mm = 10.0;

  /// Of the step that leads to the way's cell `i`, per millimetre.
  [[nodiscard]] double cost_at(const StepCosts& costs, std::size_t i) const {
    const Cell& at = way_.cells[i];
    return static_cast<double>(costs[step_between(way_.cells[i - 1], at)][patch_.at(at.row, at.col)]);
  }

  /// The middle of its first column is where the way begins, that of its last one is a whole turn on.
  static Window window(const Side& side, const Layers& layers, const WayRoundConfig& config,
                       const Vec2& begin) {
    const SideGrid& grid = side.field.grid;
    const double top_mm = grid.z_mm(*std::ranges::max_element(layers.line.row)) + config.above_mm;
    return {.s_mm = begin.x() - Patch::k_cell_mm / 2,
            .length_mm = side.outline.length_mm() + Patch::k_cell_mm,
            .z_mm = grid.z_low_mm,
            .height_mm = top_mm - grid.z_low_mm};
  }

  Patch patch_;
  StepLooks looks_;
  StepCosts costs_, bare_costs_;  ///< as doubt_way() has them
  Way way_;
};

}  // namespace

Guide way_round(const Side& side, const Layers& layers, const WayRoundConfig& config) {
  const SideGrid& grid = side.field.grid;
  const std::optional<std::size_t> col = surest_col(layers);
  if (!col) return {};
  const Vec2 begin{(static_cast<double>(*col) + 0.5) * grid.col_mm, grid.z_mm(layers.line.row[*col])};
  const double turn_mm = side.outline.length_mm();
  const Round round{side, layers, config, begin};
  if (round.begins_plain()) return round.guide(config, turn_mm);
  // The course lies on another crease there.  Where the way is plainest it does not.
  Vec2 plainest = round.plainest_place();
  plainest.x() -= turn_mm * std::floor(plainest.x() / turn_mm);
  return Round{side, layers, config, plainest}.guide(config, turn_mm);
}

}  // namespace biteline::bite_line
