// SPDX-License-Identifier: MIT
#pragma once
/// \file Does a scanning head see the line, or does the shoe stand in its light or its view?

#include <cstdint>
#include <span>
#include <vector>

#include "host/robot/path/checks/checked_path.hpp"

namespace biteline::path {

/// Where something is: cells of a box, as small as the points are dense.  Thread: const, any.
class Occupancy {
 public:
  /// `spacing_mm`: largest distance of neighbouring points on the surface.
  Occupancy(std::span<const Eigen::Vector3f> points, double spacing_mm);

  /// Something between the place and the eye?  The place's own surface is left out: within three cells of it
  /// nothing counts.
  [[nodiscard]] bool hides(const Vec3& place, const Vec3& eye) const;

 private:
  [[nodiscard]] bool occupied(const Vec3& point) const;

  double cell_mm_;
  Eigen::Array3d low_{0, 0, 0};
  Eigen::Array3i size_{0, 0, 0};
  std::vector<bool> cells_;
};

/// Of the line and the strip above it, from the camera and from the laser, at every waypoint on the line. The
/// longest stretch that either does not see must be short enough for the line to be bridged there.  Pre:
/// `sight` is the head's.
[[nodiscard]] Check sight_check(const PlannedPath& path, const Sight& sight, const Occupancy& shoe);

}  // namespace biteline::path
