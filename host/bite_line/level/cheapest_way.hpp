// SPDX-License-Identifier: MIT
#pragma once
/// \file The cheapest way between two places of the side, in any direction.

#include <cstdint>
#include <span>
#include <vector>

#include "host/bite_line/level/patch.hpp"
#include "host/bite_line/level/step_costs.hpp"

namespace biteline::bite_line {

struct Way {
  std::vector<Cell> cells;  ///< from the first to the last one; each is a step from the one before
  double cost{0};           ///< millimetres without a crease that it is as bad as
};

/// Dijkstra, "A note on two problems in connexion with graphs", Numerische Mathematik 1, 1959.
/// `barred`: per cell, 1 where a way hardly may lead; empty: nowhere.
[[nodiscard]] Way cheapest_way(const Patch& patch, const StepCosts& costs, Cell from, Cell to,
                               std::span<const std::uint8_t> barred = {});

}  // namespace biteline::bite_line
