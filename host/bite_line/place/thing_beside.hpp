// SPDX-License-Identifier: MIT
#pragma once
/// \file Where the line leaves a shoe's outline: round a pin, a clamp, a cable; or into a gap of the scan.

#include <vector>

#include "host/bite_line/place/placement.hpp"

namespace biteline::bite_line {

/// Seen from above a shoe's outline has no sharp hollow corner.  A line that has two of them within
/// `longest_mm` runs out at the one and comes back at the other.
///
///      ___      what stands beside it
///     |   |
///  ___|   |___  the line
struct ThingConfig {
  double corner_deg{35.0};        ///< inwards, of the sharper one of two corners
  double least_corner_deg{25.0};  ///< of the other one: a bridge runs out on a slant
  /// So far out, over so much of the line: beside a filled crease corners are as blunt, but no pin is there.
  double least_slanted_mm{3.0}, longest_slanted_mm{25.0};
  double from_mm{1.5};      ///< to both sides of it ...
  double to_mm{6.0};        ///< ... between these its directions are taken
  double longest_mm{60.0};  ///< along the line
  double beside_mm{3.0};    ///< of the line is as unsure, on both sides
  /// That the line is right there.  Round a pin it is not; where a filled crease jumps it is: eleven of 4110
  /// made shoes have such a stretch, and 99 of 100 of its points hold.  Which of the two it is the line
  /// cannot tell, so it stays flagged.
  double hold{0.45};
};

/// Lowers `hold` of the stations round such a thing, and sets `other_mm` to how far it stands out.
/// Where a sector was not seen on a slant, the line may follow its rim inwards and come back:
///
///  ___     ___  the line
///     \  /
///      \/      a hollow corner between two that turn outwards
///
/// Such stations are as unsure.
/// `stations`: closed, anticlockwise, `station_mm` apart.
void doubt_things_beside(double station_mm, std::vector<PlacedStation>& stations,
                         const ThingConfig& config = {});

}  // namespace biteline::bite_line
