// SPDX-License-Identifier: MIT
#pragma once
/// \file The cheapest way between two places of the side, in any direction.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "host/bite_line/level/patch.hpp"
#include "host/bite_line/level/step_costs.hpp"

namespace biteline::bite_line {

struct Way {
  std::vector<Cell> cells;  ///< from the first to the last one; each is a step from the one before
  double cost{0};           ///< millimetres without a crease that it is as bad as
};

/// The cheapest ways between one cell and all others.
struct WayTree {
  static constexpr std::int8_t k_root = -1;
  std::vector<float> total;       ///< cost, per cell
  std::vector<std::int8_t> step;  ///< of k_grid_steps: the way's last one before each cell, or its first one
                                  ///< behind it; k_root at the root and where no way was sought
};

enum class Towards : std::uint8_t { Others, Root };

/// Dijkstra, "A note on two problems in connexion with graphs", Numerische Mathematik 1, 1959.
/// `barred`: per cell, 1 where a way hardly may lead; empty: nowhere.  Without `only` to all cells.
[[nodiscard]] WayTree cheapest_ways(const Patch& patch, const StepCosts& costs, Cell root, Towards towards,
                                    std::optional<Cell> only = {}, std::span<const std::uint8_t> barred = {});

[[nodiscard]] Way cheapest_way(const Patch& patch, const StepCosts& costs, Cell from, Cell to,
                               std::span<const std::uint8_t> barred = {});

/// The cells' places: s, z.
[[nodiscard]] std::vector<Vec2> places_of(const Patch& patch, const Way& way);

/// Of a way along these cells, each a step from the one before.
[[nodiscard]] double cost_of(const Patch& patch, const StepCosts& costs, std::span<const Cell> cells);

/// The cells of the way between a cell and the root, that cell first.
[[nodiscard]] std::vector<Cell> cells_to_root(const Patch& patch, const WayTree& tree, Towards towards,
                                              Cell from);

}  // namespace biteline::bite_line
