// SPDX-License-Identifier: MIT
#pragma once
/// \file A checked path as the generic protocol's points.

#include <vector>

#include "common/arm_link/messages.hpp"
#include "host/robot/path/checks/checked_path.hpp"

namespace biteline::robot::other {

struct PathPoints {
  arm_link::PathBegin begin;
  std::vector<arm_link::PathPoint> points;
};

/// The ways and speeds of ur/script.hpp: joints to the first waypoint (that fixes the configuration),
/// straight down, along the line with blends that leave their neighbours room, straight away.  The tool is on
/// only along the line, and where it changes the arm stands.  \param name of the path, not 0
[[nodiscard]] PathPoints path_points(const path::CheckedPath& path, std::uint32_t name);

}  // namespace biteline::robot::other
