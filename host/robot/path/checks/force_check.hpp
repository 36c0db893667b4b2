// SPDX-License-Identifier: MIT
#pragma once
/// \file Whether a path may press as it says: direction, force, and an arm that can.

#include <vector>

#include "host/robot/path/checks/checked_path.hpp"

namespace biteline::path {

/// From the waypoints alone: "force direction" (a unit direction at each place of the line, across the way),
/// "force" (above the touch, and so far below the largest that a ramp's overshoot ends no run), "force mode"
/// (the arm has a force sensor of its own).
/// By a flange the last is replaced: "flange's force" (it gives so much), "flange's stroke" (it lies along
/// the force).  Empty for a path that does not press.
[[nodiscard]] std::vector<Check> force_checks(const PlannedPath& path);

/// The arm's controller knows force_mode, zero_ftsensor and force_mode_set_gain_scaling: e-Series and later
/// (Universal Robots, "The URScript Programming Language"); a CB3 has no sensor in its flange.
[[nodiscard]] bool has_force_sensor(const std::string& robot);

}  // namespace biteline::path
