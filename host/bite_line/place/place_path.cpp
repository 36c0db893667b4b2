// SPDX-License-Identifier: MIT
#include "host/bite_line/place/place_path.hpp"

#include <optional>
#include <vector>

#include <tbb/parallel_invoke.h>

#include "host/bite_line/place/hidden_corner.hpp"

namespace biteline::bite_line {

PlacedLine place_path(const ScanPoints& scan, const Side& side, std::span<const double> path_row,
                      const AlongPath& along, double spacing_mm) {
  PooledVector<Eigen::Vector3f> near;
  std::optional<PathCurve> path;
  tbb::parallel_invoke([&] { near = points_behind(scan, side.shoe, near_path(side.field, path_row)); },
                       [&] { path = curve_of(side.field, side.outline, path_row, spacing_mm); });
  PlacedLine placed = place_line({.near = near,
                                  .points_per_mm2 = side.field.points_per_mm2 * scan.points_per_run(),
                                  .field = side.field,
                                  .outline = side.outline,
                                  .path = *path,
                                  .hold = along.hold,
                                  .other_mm = along.other_mm,
                                  .sharp = along.sharp,
                                  .upright_ratio = along.upright_ratio},
                                 {});
  // A straightened line shows no climb: place_along() has its own doubts of gaps.
  if (along.upright_ratio.empty()) {
    std::vector<Vec2> places;
    const double turn_mm = path->outline.length_mm();
    const auto count = static_cast<double>(placed.points.size());
    for (const PlacedStation& station : placed.points)
      places.emplace_back(turn_mm * static_cast<double>(places.size()) / count, station.position.z());
    doubt_hidden_corners(places, turn_mm, placed);
  }
  return placed;
}

}  // namespace biteline::bite_line
