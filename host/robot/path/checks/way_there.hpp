// SPDX-License-Identifier: MIT
#pragma once
/// \file The arm's way from where it stands to a path's beginning.

#include "host/robot/path/checks/checked_path.hpp"

namespace biteline::path {

inline constexpr double k_most_way_ratio = 3;

struct WayThere {
  Check check;  ///< nearest distance along the way, or of the direct one when none is free
  std::optional<CheckedPath> path;  ///< entered by that way; present when it is free
};

/// Joint moves, straight in joint space as movej makes them: directly, or over postures raised above both
/// ends, whichever first keeps clear of table, shoe and arm.  An arm that stands closer to something than the
/// limit may leave, and comes no nearer.  A path that purges goes over that posture, both ways so.  The
/// joints go at the process's speed for such ways, and at up to k_most_way_ratio of it where nothing from the
/// elbow to the tip then goes faster than its `transfer_speed_mm_s`.  Cost: some milliseconds.
[[nodiscard]] WayThere find_way_there(const kinematics::Joints& from_rad, const CheckedPath& path,
                                      const kinematics::ArmModel& arm, const CollisionModel& collisions);

/// Whether the straight joint move from one posture to the other is such a way.
[[nodiscard]] bool is_free_way(const kinematics::Joints& from_rad, const kinematics::Joints& to_rad,
                               const kinematics::ArmModel& arm, const CollisionModel& collisions);

}  // namespace biteline::path
