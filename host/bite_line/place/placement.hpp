// SPDX-License-Identifier: MIT
#pragma once
/// \file The line's exact place: where the section curves most, found in the raw points around a path.

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "host/bite_line/place/normals.hpp"
#include "host/bite_line/place/path_curve.hpp"
#include "host/bite_line/place/place_noise.hpp"
#include "host/bite_line/pooled_vector.hpp"
#include "host/bite_line/shoe/plan.hpp"
#include "host/bite_line/side/side_field.hpp"

namespace biteline::bite_line {

struct PlacementConfig {
  double smoothing_mm{0.4};  ///< standard deviation in height: the definition's
  double search_mm{2.5};     ///< from the path: the definition's
  double mean_mm{8.5};       ///< running mean along the line: the definition says 7 to 10
  NormalConfig normals{};
};

/// One point of the placed line, in shoe.
struct PlacedStation {
  Vec3 position{Vec3::Zero()};
  Vec3 normal{Vec3::UnitX()};
  double curvature_per_mm{0};  ///< largest curvature of the section, concave > 0
  double own_z_mm{0};          ///< height of the section's own place, before the running mean
  double to_visible_mm{
      0};  ///< distance along the line to the nearest place where the crease was seen; 0 there
  /// Expected error over 0.3 mm where the crease, or the surface at its own depth, was not seen; 0 elsewhere.
  double doubt{0};
  /// Where the surface was not seen: how far a course that turns sharper could lie outside, or one that goes
  /// straight after a kink at the gap's end inside, whichever is more.
  double corner_mm{0};
  /// What bridges of that length are off by elsewhere on this line (RMS), level, or more where the gap's own
  /// ends allow more ...
  double tried_out_mm{0};
  double tried_up_mm{0};   ///< ... and in height; 0 where it was seen, and where none could be tried
  double hidden_up_mm{0};  ///< where a gap may hide a corner of the line: standard deviation in height
  /// In a long gap, and the line was not seen over enough such lengths to try one, or the surface was seen
  /// there and has no crease.
  bool untried{false};
  /// Of a bend that lies between two profiles, or within a wide section: standard deviation, level ...
  double between_out_mm{0};
  double between_up_mm{0};  ///< ... and in height
  double few_out_mm{0};     ///< where points are few: standard deviation outwards, see half_spread()
  PlaceNoise noise{};
  /// RMS of the sections' own heights about their running mean, over its length; more where few were seen.
  double scatter_mm{0};
  double hold{1};            ///< that the path keeps its layer here ...
  double other_mm{0};        ///< ... and how far off the other layer is
  double sharp{1};           ///< 1 but where a weak crease lies on a flat slope
  bool thing_beside{false};  ///< something hides the shoe here, or the line runs round it
};

/// Expected error of a place in a gap, over 0.3 mm: `to_known` from its nearer end, in a gap so long and over
/// which the line turns so far.  Fitted to some 6000 bridged points of made shoes of all classes with sectors
/// of 8 to 40 mm missing, so that 1 / (1 + doubt) is the share of the points within 0.3 mm (bench_line_class
/// shows it).
[[nodiscard]] double gap_doubt(double to_known_mm, double length_mm, double turn_rad);

struct PlacedLine {
  std::vector<PlacedStation> points;  ///< closed, evenly spaced, anticlockwise
  double length_mm{0};
  double bridged_mm{0};
  double thing_beside_mm{0};  ///< of the length, see PlacedStation
};

/// Points of the outermost layer within reach of the path's height (a row of the grid per column): what
/// place_line() works on.
[[nodiscard]] PooledVector<std::uint32_t> near_path(const SideField& field, std::span<const double> path_row);

/// `near` in shoe: all raw points round the path, `points_per_mm2` of the surface.
///
/// The place of the line by its definition: section by the upright plane along the outline's normal; o(z)
/// smoothed by a Gaussian; k = o'' / (1 + o'^2)^1.5; z of largest k near the path; running mean along the
/// line; the point on the unsmoothed surface at that z.  The outline is the path's own, so that the sections
/// are square to the line.
struct PlacementInput {
  std::span<const Eigen::Vector3f> near;
  double points_per_mm2;
  const SideField& field;
  const Outline& outline;
  const PathCurve& path;
  /// Of each column, see PlacedStation; empty: one layer and sharp everywhere.
  std::span<const float> hold{};
  std::span<const float> other_mm{};
  std::span<const float> sharp{};
  std::span<const float> upright_ratio{};  ///< per column, see section_curvature(); empty: 1 everywhere
};
[[nodiscard]] PlacedLine place_line(const PlacementInput& input, const PlacementConfig& config);

}  // namespace biteline::bite_line
