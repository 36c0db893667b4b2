// SPDX-License-Identifier: MIT
#pragma once
/// \file Where along a path a tip is.

#include "host/robot/path/checks/checked_path.hpp"

namespace biteline::path {

/// A place between two waypoints.
struct PathPlace {
  std::size_t segment{0};  ///< from this waypoint to the next
  double fraction{0};
  double distance_mm{1e9};  ///< of the tip that was asked for
};

/// A stretch of the path; only there a place is looked for, so that the overlap of the seam is not confused
/// with the beginning.
struct Stretch {
  double from_mm{0};
  double to_mm{0};
};

/// The place nearest to `tip`.  Pre: the path has two waypoints at least.
[[nodiscard]] PathPlace nearest_place(const PlannedPath& path, const Vec3& tip, const Stretch& within);

[[nodiscard]] SE3 pose_at(const PlannedPath& path, const PathPlace& place);
[[nodiscard]] double arc_at(const PlannedPath& path, const PathPlace& place);
/// Planned, from the path's beginning.
[[nodiscard]] double time_at(const PlannedPath& path, const PathPlace& place);

}  // namespace biteline::path
