// SPDX-License-Identifier: MIT
#pragma once
/// \file Whether a controller takes a path as a program: blends, number of targets, rest at both ends.

#include <vector>

#include "host/robot/path/checks/checked_path.hpp"

namespace biteline::path {

/// Waypoints in a row, first to last.
struct PathRun {
  std::size_t first, last;
};
/// Of one kind, in their order.
[[nodiscard]] std::vector<PathRun> runs_of(const PlannedPath& path, Segment segment);
/// The same with the waypoint that each begins at: a travel begins where the way up ends.
[[nodiscard]] std::vector<PathRun> rounded_runs(const PlannedPath& path);
/// The tips of a run, as the program has them.
[[nodiscard]] std::vector<Vec3> tips_of(const PlannedPath& path, const PathRun& run);

/// "blends apart", "program size", "rest at the ends", from the waypoints alone.
[[nodiscard]] std::vector<Check> program_checks(const PlannedPath& path);

}  // namespace biteline::path
