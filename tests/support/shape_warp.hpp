// SPDX-License-Identifier: MIT
#pragma once
/// \file Shapes of public origin made into others of their kind: stretched, bent, turned, thinned, with gaps.

#include <cstdint>

#include "common/geometry/se3.hpp"
#include "host/cloud/closed_line.hpp"
#include "host/cloud/point_cloud.hpp"

namespace biteline::test {

/// A smooth map of a shape in its own frame, mm: x from heel to toe, z up, and what a scan of it lacks.
struct ShapeWarp {
  Vec3 scale{1, 1, 1};
  double spring_mm{0}, spring_phase_rad{0};  ///< z goes up and down along x: toe spring, heel height
  double curve_mm{0}, curve_phase_rad{0};    ///< y does: a last is more or less curved
  double wave_mm{300};                       ///< length of both
  double yaw_rad{0}, tilt_rad{0}, tilt_to_rad{0};
  bool mirrored{false};
  double noise_mm{0};
  double kept_share{1};                    ///< of the points
  double sector_rad{0}, sector_at_rad{0};  ///< seen from the middle: a sector that was not seen
  std::uint32_t seed{0};

  /// One of many that a shoe's shape may have: lengths by 15 %, heights by 20 %, bends by 5 mm.
  static ShapeWarp drawn(std::uint32_t seed);
  /// Turned, tilted and mirrored alike; all else as it is.
  [[nodiscard]] ShapeWarp rigid() const;

  [[nodiscard]] Vec3 place(const Vec3& at) const;
  /// Points' order and profiles are those of the cloud; none where it is mirrored.
  [[nodiscard]] cloud::PointCloud cloud(const cloud::PointCloud& of) const;
  [[nodiscard]] cloud::ClosedLine line(cloud::ClosedLine of) const;
};

}  // namespace biteline::test
