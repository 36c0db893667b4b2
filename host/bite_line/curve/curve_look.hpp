// SPDX-License-Identifier: MIT
#pragma once
/// \file What curves look like along their way, over stretches of them.

#include <optional>
#include <span>
#include <vector>

#include "host/bite_line/curve/curve_ground.hpp"
#include "host/bite_line/curve/curve_search.hpp"

namespace biteline::bite_line {

/// A curve's place whose surface was seen.
struct SeenPlace {
  CreaseSigns signs;
  double per_mm;  ///< what it costs
  double mm;      ///< to the next place
};
/// A place for each state.
using PlacesAlong = std::vector<std::optional<SeenPlace>>;
[[nodiscard]] PlacesAlong places_along(const CurveGround& ground, std::span<const CurveState> states);
/// Of `count` places from the `first` on, once round and on: those that were seen.
[[nodiscard]] std::vector<SeenPlace> seen_of(const PlacesAlong& places, std::size_t first, std::size_t count);

/// Means; 0 of none.
[[nodiscard]] double mean_of(std::span<const SeenPlace> places, CreaseSign sign);
[[nodiscard]] double mean_per_mm(std::span<const SeenPlace> places);
/// Of the costs' means over some 12 mm: their standard deviation.
[[nodiscard]] double uneven_along(std::span<const SeenPlace> places);
/// What those 3 mm cost for each millimetre that look the least like a line.
[[nodiscard]] double faintest_of(std::span<const SeenPlace> places);

/// How 10 mm to both sides of a curve's place look, where they were seen.
struct PlaceLook {
  bool seen{false};
  double per_mm{0};        ///< what they cost
  double rim{0};           ///< mean of RimRight: an overlay's edge has one close below
  double unlike_rim{0};    ///< how far that is from its median along the curve
  double unlike_below{0};  ///< the same of RightCrease: another crease begins or ends below
};
struct CurveLook {
  double per_mm{0};                 ///< what the whole curve costs, where it was seen
  std::vector<PlaceLook> places{};  ///< one for each place
};
[[nodiscard]] CurveLook look_of(const PlacesAlong& closed);

}  // namespace biteline::bite_line
