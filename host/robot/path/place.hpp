// SPDX-License-Identifier: MIT
#pragma once
/// \file Where along a path a tip is.

#include <optional>

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

/// So near to a waypoint the tip has been there.
inline constexpr double k_passed_mm = 0.5;

/// Goes along a path with its tip, sample by sample: at the seam the overlap is not taken for the beginning.
/// The path outlives it.
class AlongPath {
 public:
  explicit AlongPath(const PlannedPath& path) : path_{path} {}
  /// Nothing before the path's beginning: the way there is the arm's own.
  [[nodiscard]] std::optional<PathPlace> next(const Vec3& tip);
  /// As far as the tip has come.
  [[nodiscard]] double here_mm() const { return here_mm_; }

 private:
  const PlannedPath& path_;
  double here_mm_{-1};
};

}  // namespace biteline::path
