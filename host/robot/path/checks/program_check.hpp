// SPDX-License-Identifier: MIT
#pragma once
/// \file Whether a controller takes a path as a program: blends, number of targets, rest at both ends.

#include <vector>

#include "host/robot/path/checks/checked_path.hpp"

namespace biteline::path {

/// The line's part as the program has it, first to last.  Empty when no waypoint is on the line.
[[nodiscard]] std::vector<Vec3> line_tips(const PlannedPath& path);

/// "blends apart", "program size", "rest at the ends", from the waypoints alone.
[[nodiscard]] std::vector<Check> program_checks(const PlannedPath& path);

}  // namespace biteline::path
