// SPDX-License-Identifier: MIT
#pragma once
/// \file Whether an outline is a shoe's: broad at the ball of the foot, narrower at waist and heel, round at
/// both ends.

#include <array>
#include <cstddef>

#include "host/bite_line/shoe/plan.hpp"

namespace biteline::bite_line {

/// The outline's breadth along its length, from heel to toe.
struct PlanShape {
  static constexpr std::array<double, 9> k_at{0.03, 0.10, 0.20, 0.35, 0.50, 0.65, 0.80, 0.90, 0.97};
  std::array<double, k_at.size()> breadth{};  ///< at these shares of the length, over the greatest
  double broadest_at{0};                      ///< middle of what is at least 98 % of the greatest
  double breadth_to_length{0};
};

/// `outline` in shoe: x from heel to toe.
[[nodiscard]] PlanShape plan_shape(const Outline& outline);

}  // namespace biteline::bite_line
