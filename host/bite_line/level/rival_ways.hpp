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

/// What speaks against the cheapest way `way`: rivals, a plain crease all along above it, stretches that were
/// not seen, and what lies between two stretches that are unsure.  Who leaves a crease and comes back to it
/// does so at two places; the longest stretch between two is the line's.
///
/// Rivals are told by the min-marginals of the graph: for each place, the cheapest way through it.
[[nodiscard]] WayDoubt doubt_way(const Patch& patch, const StepCosts& costs, const Way& way,
                                 const RivalWaysConfig& config);

/// The least margin of a rival of `way`, whose cost over `costs` is `way.cost`; 1 where it has none.
[[nodiscard]] double least_margin(const Patch& patch, const StepCosts& costs, const Way& way,
                                  const RivalWaysConfig& config);

}  // namespace biteline::bite_line
