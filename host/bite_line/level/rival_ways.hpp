// SPDX-License-Identifier: MIT
#pragma once
/// \file Where another way than the cheapest one is about as good.

#include <vector>

#include "host/bite_line/level/cheapest_way.hpp"

namespace biteline::bite_line {

struct RivalWaysConfig {
  double apart_mm{2.5};           ///< what is nearer is the same way
  float shows_cost{0.8F};         ///< of a place that shows a crease
  double most_unseen_mm{8};       ///< what was not seen over so much may lead anywhere
  double far_mm{5};               ///< what leads so far up leaves a crease of its own below it ...
  double least_far_margin{0.16};  ///< ... and is a rival up to this margin (DetourConfig has it, too)
  double left_above_mm{60};       ///< a plain crease that is left above over so much is the line
  int most{200};                  ///< rivals looked at, the cheapest first
};

/// Per cell of a way, as Layers::hold and other_mm have it.
struct WayDoubt {
  std::vector<float> hold;
  std::vector<float> other_mm;
};

/// What speaks against the cheapest way `way`: rivals, places where it branches off a crease, a plain crease
/// all along above it, stretches that were not seen, and what lies between two stretches that are unsure.
/// Who leaves a crease and comes back to it does so at two places; the longest stretch between two is the
/// line's.
///
/// Rivals are told by the min-marginals of the graph: for each place, the cheapest way through it.
/// `bare_costs`: the same, but nothing is made of a crease that is left above.
[[nodiscard]] WayDoubt doubt_way(const Patch& patch, const StepCosts& costs, const StepCosts& bare_costs,
                                 const Way& way, const RivalWaysConfig& config);

/// Whether another way is plainer, but for what it leaves above: a cap's edge over a guard's is no line.
[[nodiscard]] bool leaves_plainer(const Patch& patch, const StepCosts& bare_costs, const Way& way,
                                  const RivalWaysConfig& config);

}  // namespace biteline::bite_line
