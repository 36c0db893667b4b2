// SPDX-License-Identifier: MIT
#pragma once
/// \file The way round the whole side, in any direction, for a course that changes its crease.

#include <vector>

#include "common/geometry/se3.hpp"
#include "host/bite_line/layers/layers.hpp"
#include "host/bite_line/side/side.hpp"

namespace biteline::bite_line {

struct WayRoundConfig {
  /// Of a millimetre of the outline, as a mean: a crease that is plain nearly all the way round.  Read off
  /// 600 made shoes with guards, with a trial of these rules: of 46 ways that cost less one led to a wrong
  /// line, in a corner; of 24 that cost more ten did.
  double most_cost{0.05};
  double above_mm{40};  ///< over the course's highest place: so far up the way may lead
};

/// The cheapest closed way, as guide_of() has it: from the middle of the course's longest stretch on a plain
/// crease once round.  Empty where it costs too much.
[[nodiscard]] std::vector<Vec2> way_round(const Side& side, const Layers& layers,
                                          const WayRoundConfig& config);

}  // namespace biteline::bite_line
