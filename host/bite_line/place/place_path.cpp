// SPDX-License-Identifier: MIT
#include "host/bite_line/place/place_path.hpp"

namespace biteline::bite_line {

PlacedLine place_path(const ScanPoints& scan, const Side& side, std::span<const double> path_row,
                      const AlongPath& along, double spacing_mm) {
  return place_line({.near = points_behind(scan, side.shoe, near_path(side.field, path_row)),
                     .points_per_mm2 = side.field.points_per_mm2 * scan.points_per_run(),
                     .field = side.field,
                     .outline = side.outline,
                     .path_row = path_row,
                     .hold = along.hold,
                     .other_mm = along.other_mm,
                     .sharp = along.sharp},
                    {.spacing_mm = spacing_mm});
}

}  // namespace biteline::bite_line
