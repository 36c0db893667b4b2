// SPDX-License-Identifier: MIT
#pragma once
/// \file What a way over a piece of the side costs in any direction.

#include <array>
#include <vector>

#include "host/bite_line/layers/evidence.hpp"
#include "host/bite_line/level/patch.hpp"

namespace biteline::bite_line {

/// What the surface shows of each step.
struct StepLooks {
  /// Per axis and cell: the turn of the surface across it, concave > 0.
  std::array<std::vector<float>, k_grid_steps.size() / 2> turn_rad;
  /// Per step and cell, 0 to 1: a crease that has the sole to its right, as ColumnLikeness has it.
  std::array<std::vector<float>, k_grid_steps.size()> likeness;
};
struct StepLookConfig {
  double flank_mm{1.0};  ///< to both sides, over which the surface's turn is read
  /// Where the surface turns outwards by so much close below a crease, the sole ends: at a rim, or at a lip.
  /// 0: nothing is made of that.
  double rim_rad{0};
};
[[nodiscard]] StepLooks look_at_steps(const Patch& patch, const StepLookConfig& config);

/// Of a millimetre along each step: about 0 on a crease with the sole to its right, 1 where nothing is, and
/// more where an edge is crossed, or where nothing was seen.
using StepCosts = std::array<std::vector<float>, k_grid_steps.size()>;
inline constexpr float k_unseen_cost = 2;
/// `above_to_mm`: so far up a crease counts as left above.
[[nodiscard]] StepCosts step_costs(const Patch& patch, const StepLooks& looks,
                                   double above_to_mm = EvidenceConfig{}.above_to_mm);

}  // namespace biteline::bite_line
