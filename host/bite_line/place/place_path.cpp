// SPDX-License-Identifier: MIT
#include "host/bite_line/place/place_path.hpp"

#include <optional>

#include <tbb/parallel_invoke.h>

namespace biteline::bite_line {

PlacedLine place_path(const ScanPoints& scan, const Side& side, std::span<const double> path_row,
                      const AlongPath& along, double spacing_mm) {
  Large<Eigen::Vector3f> near;
  std::optional<PathCurve> path;
  tbb::parallel_invoke([&] { near = points_behind(scan, side.shoe, near_path(side.field, path_row)); },
                       [&] { path = curve_of(side.field, side.outline, path_row, spacing_mm); });
  return place_line({.near = near,
                     .points_per_mm2 = side.field.points_per_mm2 * scan.points_per_run(),
                     .field = side.field,
                     .outline = side.outline,
                     .path = *path,
                     .hold = along.hold,
                     .other_mm = along.other_mm,
                     .sharp = along.sharp,
                     .upright_ratio = along.upright_ratio},
                    {});
}

}  // namespace biteline::bite_line
