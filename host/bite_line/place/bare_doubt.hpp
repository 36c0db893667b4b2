// SPDX-License-Identifier: MIT
#pragma once
/// \file Where the line runs over a surface that was seen and shows no crease.

#include <cstdint>
#include <span>
#include <vector>

#include "host/bite_line/place/placement.hpp"
#include "host/bite_line/place/ridge.hpp"

namespace biteline::bite_line {

/// A surface that was seen over a long stretch and shows no crease says that the line goes another way: then
/// it is there with less than one half.  It leaves the line's crease before that, and what the sections show
/// of it fades.  So the stretch goes on to both sides, by at most `most_fade_mm`, over what is less than half
/// as sharp as the line usually is.
///
///      line's crease      fades     bare       fades     line's crease
///     _______________-----......____________......-----_______________
///                         |<------- doubted ------->|
///
/// Sets `doubt` and `untried` of these stations.  `bare`: per station, seen and without a crease.
void doubt_bare(std::span<const std::uint8_t> bare, const Ridge& ridge, double station_mm,
                double most_fade_mm, std::vector<PlacedStation>& stations);

}  // namespace biteline::bite_line
