// SPDX-License-Identifier: MIT
#pragma once
/// \file The noise of the surface at the line.

#include <cstdint>
#include <span>
#include <vector>

#include "host/bite_line/place/sections.hpp"

namespace biteline::bite_line {

struct PlaceNoise {
  double outward_mm{0};  ///< standard deviation of the surface at the line
  double slope{0};       ///< do/dz at the line: a change of height moves the point outwards by so much
  double round_mm{0};    ///< by so much the sections' own smoothing lies outside the crease
  double filled_mm{0};   ///< where the hollow's bottom was not seen: standard deviation outwards
};

/// Per station.  The noise is read from the sections' second differences beside the crease, where the surface
/// is nearly straight, and averaged over `mean_mm` along the line; where no crease is `visible` it says
/// nothing. `row`: of the line per station.
[[nodiscard]] std::vector<PlaceNoise> place_noise(const Sections& sections, std::span<const double> row,
                                                  std::span<const std::uint8_t> visible, double mean_mm);

}  // namespace biteline::bite_line
