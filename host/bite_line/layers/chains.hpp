// SPDX-License-Identifier: MIT
#pragma once
/// \file How far round each crease of the side goes on: a bite line goes all the way round, the edge of a
/// cap, a counter or a bumper does not.

#include <span>
#include <vector>

#include "host/bite_line/large.hpp"
#include "host/bite_line/side/side_field.hpp"

namespace biteline::bite_line {

struct ChainConfig {
  float least_likeness{0.15F};  ///< of a place that belongs to a crease
  /// A crease goes on where it keeps this much of its likeness: a trace of it is no more than its shadow.
  float as_strong_ratio{0.5F};
  double apart_mm{1.0};  ///< a crest is the highest within so much
  /// Most change of height from column to column of a crease that goes on plainly, and where it has to jump:
  /// that waits until all have gone on plainly, so that no edge that runs up to a crease takes its place.
  double smooth_mm{0.75};
  double step_mm{1.0};
  double bridge_mm{45.0};    ///< so far a crease may not be there, or not be seen, and go on behind
  double bridge_rise{0.12};  ///< most change of height on the way over a gap, beyond a step
};

/// For each place the share of the way round that the crease through it, or nearest to it within `apart_mm`,
/// goes on about as strong as there; 0 where there is none.
///
/// Crests of neighbouring columns are joined where each is the other's nearest, so a crease that runs into
/// another one ends there.  Ends that face each other over a gap are joined in the same way.
[[nodiscard]] Large<float> share_round(const SideGrid& grid, std::span<const float> likeness,
                                       const ChainConfig& config);

}  // namespace biteline::bite_line
