// SPDX-License-Identifier: MIT
#pragma once
/// \file What a corner in a gap would do to the height of a bridged line.

#include <span>
#include <vector>

#include "common/geometry/se3.hpp"
#include "host/bite_line/place/placement.hpp"

namespace biteline::bite_line {

/// Soles climb in curves, but where one wraps up over the toe its edge has corners.  A gap may hide one: at
/// either end the line may go straight on, or turn at once to where the other end points.
///
///            end, climbing
///          . /
///        .  .            . . the bridge
///   ___.___.             _____ a course with a corner: so far away may the line be
///
/// Half of that is a standard deviation where the line climbs by 30 degrees and more at the gap, as guards
/// alone make it, and nothing below 20.  Gaps below 8 mm add none.
///
/// `place`: of each station, along the outline and up, mm; `turn_mm`: once round the outline.  Sets
/// PlacedStation::hidden_up_mm.
void doubt_hidden_corners(std::span<const Vec2> place, double turn_mm, PlacedLine& placed);

}  // namespace biteline::bite_line
