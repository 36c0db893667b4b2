// SPDX-License-Identifier: MIT
#pragma once
/// \file Where a path had better enter the line when it is known where the arm stands before.

#include "host/robot/path/checks/obstacles.hpp"
#include "host/robot/path/tool_path.hpp"

namespace biteline::path {

/// The places to enter the line in the order in which they had better be tried: the least harmful first, but
/// not for a little less harm on the far side of the shoe.  `from_rad`: where the arm stands, if known.
[[nodiscard]] std::vector<Seam> seams_in_order(const cloud::ClosedLine& line, const Process& process,
                                               const kinematics::ArmModel& arm,
                                               const std::optional<kinematics::Joints>& from_rad);

/// The posture with the tip there to which the joint with the farthest way has the shortest, over branches
/// and free turns; what stands in the way is not looked at.  None: out of reach.
[[nodiscard]] std::optional<kinematics::Joints> nearest_posture(const kinematics::ArmModel& arm,
                                                                const SE3& T_base_tcp, const Tool& tool,
                                                                const kinematics::Joints& from_rad);

/// How much farther back along the tool than the process asks the way in had better begin, so that the arm
/// comes there straight: a longer way in takes less time than a detour, which stops.  0 also where no way in
/// helps.
[[nodiscard]] double farther_back_mm(const Seam& seam, const Tool& tool, const kinematics::ArmModel& arm,
                                     const CollisionModel& collisions, const kinematics::Joints& from_rad);

}  // namespace biteline::path
