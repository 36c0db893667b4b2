// SPDX-License-Identifier: MIT
#pragma once
/// \file The way round the whole side, in any direction, for a course that changes its crease.

#include "host/bite_line/layers/layers.hpp"
#include "host/bite_line/level/levelled.hpp"
#include "host/bite_line/side/side.hpp"

namespace biteline::bite_line {

struct WayRoundConfig {
  /// Of a millimetre of the outline, as a mean.  Dearer ways hardly show a crease.  That a cheaper one is the
  /// line, its rivals tell.
  double most_cost{0.3};
  double above_mm{40};  ///< over the course's highest place: so far up the way may lead
  /// The line's own definition smooths by 0.4 mm.  A wider turn takes a bulge of the upper for a crease, and
  /// washes out a seam of 0.2 mm by one.
  double sigma_mm{0.5};
  double flank_mm{0.5};
  double rim_rad{0.2};
};

/// The cheapest closed way, from the middle of the course's longest stretch on a plain crease once round, and
/// what speaks against it.  Empty where it costs too much.
[[nodiscard]] Guide way_round(const Side& side, const Layers& layers, const WayRoundConfig& config);

}  // namespace biteline::bite_line
