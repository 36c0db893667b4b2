// SPDX-License-Identifier: MIT
#pragma once
/// \file The way round the whole side, in any direction, for a course that changes its crease.

#include "host/bite_line/layers/layers.hpp"
#include "host/bite_line/level/levelled.hpp"
#include "host/bite_line/side/side.hpp"

namespace biteline::bite_line {

struct WayRoundConfig {
  /// Of a millimetre of the outline, as a mean: a crease that is plain nearly all the way round.  Dearer ways
  /// round made guards lead below them too often, along a welt or a bumper: three of 250 that nobody had
  /// seen.
  double most_cost{0.05};
  /// Where the side ends close below the way over so much of its length, the sole is a thin plate.  Then it
  /// has no other creases, and its rim says what a faded crease does not.
  double least_thin_share{0.4};
  double most_thin_cost{0.3};
  double above_mm{40};  ///< over the course's highest place: so far up the way may lead
  /// The line's own definition smooths by 0.4 mm.  A wider turn takes a bulge of the upper for a crease, and
  /// washes out a seam of 0.2 mm by one.
  double sigma_mm{0.5};
  double flank_mm{0.5};
  double rim_rad{0.2};
  double left_above_mm{35};  ///< a guard's edge is left above from so far below
};

/// The cheapest closed way, and what speaks against it.  Empty where it costs too much.  It begins in the
/// middle of the course's longest stretch on a plain crease; where it leaves that at once, in that of its
/// own.
[[nodiscard]] Guide way_round(const Side& side, const Layers& layers, const WayRoundConfig& config);

}  // namespace biteline::bite_line
