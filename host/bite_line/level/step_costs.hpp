// SPDX-License-Identifier: MIT
#pragma once
/// \file What a way over a piece of the side costs in any direction.

#include <array>
#include <vector>

#include "host/bite_line/level/patch.hpp"

namespace biteline::bite_line {

/// Of a millimetre along each step: about 0 on a crease with the sole to its right, 1 where nothing is, and
/// more where an edge is crossed.
using StepCosts = std::array<std::vector<float>, k_grid_steps.size()>;
[[nodiscard]] StepCosts step_costs(const Patch& patch);

}  // namespace biteline::bite_line
