// SPDX-License-Identifier: MIT
#pragma once
/// \file The upper's normals beside the line, averaged over a height above it.

#include <span>
#include <vector>

#include "host/bite_line/place/sections.hpp"
#include "host/bite_line/shoe/plan.hpp"

namespace biteline::bite_line {

struct NormalConfig {
  double from_mm{2.0};  ///< averaged from here above the line ...
  double to_mm{6.0};    ///< ... to here
};

struct NormalInput {
  const SectionPoints& points;
  const Sections& sections;  ///< of these points, smooth: what lies far from them is a stray
  const Outline& outline;
  std::span<const double> line_z_mm;  ///< per station, in shoe
  std::span<const Vec2> line_plan;    ///< the same, also across what was not seen
};

/// One per station.
///
/// In strips of a quarter of a millimetre, each a spline round the shoe through the profiles' own points:
/// stitches, 3 mm apart and scanned once a millimetre, tilt the surface and count as they should.  The mean
/// of the slope up over the height is the difference between its ends, so noise hardly counts.  A strip that
/// was not seen somewhere has the slopes of its own ends there, against the line's own direction: a hole in
/// half of the height does not tilt the normal of a wall that bends.
[[nodiscard]] std::vector<Vec3> normals_above(const NormalInput& input, const NormalConfig& config);

}  // namespace biteline::bite_line
