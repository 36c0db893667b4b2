// SPDX-License-Identifier: MIT
#pragma once
/// \file Where the tool gives its first drops before the line: beside the shoe, straight down.

#include <optional>

#include "host/robot/path/checks/line_check.hpp"
#include "host/robot/path/checks/obstacles.hpp"
#include "host/robot/path/process.hpp"

namespace biteline::path {

/// The process asks for it, and this path lets the tool flow.
[[nodiscard]] bool purges(const std::optional<Flow>& flow, bool tool_off);

/// The posture with the tip at the process's place and the tool straight down from which the joint with the
/// farthest way to `to_rad` has the shortest.  None: out of reach.  Whether its ways are free is
/// find_way_there()'s.
[[nodiscard]] std::optional<kinematics::Joints> purge_posture(const kinematics::ArmModel& arm,
                                                              const Tool& tool, const Flow& flow,
                                                              const kinematics::Joints& to_rad);

/// Nothing of it falls on the shoe: seen from above, the place lies so far beside all that is known of it,
/// and a cone's half width at the table more.
[[nodiscard]] Check check_purge(const Process& process, const Surroundings& surroundings);

}  // namespace biteline::path
