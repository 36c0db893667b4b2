// SPDX-License-Identifier: MIT
#pragma once
/// \file Where the line may lie in another hollow beside it, too close for two layers.

#include <cstdint>
#include <span>
#include <vector>

#include "host/bite_line/place/placement.hpp"
#include "host/bite_line/place/ridge.hpp"

namespace biteline::bite_line {

/// Lowers `hold` of the stations, and sets `other_mm`, where another hollow is about as sharp in most
/// sections over the running mean's length of `steps` stations.  Most and not their mean: one stray makes one
/// wild section.  Bridged stations have no vote, and where fewer than a quarter were seen there is none.  A
/// point whose mean takes in a quarter and more of such a place is as unsure.
void doubt_ridge(const Ridge& ridge, double steps, std::vector<PlacedStation>& stations);

/// The same over the gaps of `known`: a bridge leans on both its ends.  Where one of them is
/// rather in another hollow than on the line, the bridge is off by that at this end, and by nothing at the
/// other one.
void doubt_bridges(std::span<const std::uint8_t> known, std::vector<PlacedStation>& stations);

}  // namespace biteline::bite_line
