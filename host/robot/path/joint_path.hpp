// SPDX-License-Identifier: MIT
#pragma once
/// \file Which joints follow a tool path: branch of the arm and free turn of the tool, chosen over the whole
/// path at once.

#include <optional>
#include <string>
#include <vector>

#include "host/robot/kinematics/arm_model.hpp"
#include "host/robot/path/checks/obstacles.hpp"
#include "host/robot/path/tool_path.hpp"

namespace biteline::path {

struct JointPath {
  std::vector<kinematics::Joints> q_rad;  ///< one per tool point, continuous, whole turns counted
  std::vector<double> turn_rad;           ///< of the tool about its axis
};

enum class Obstacle { None, Reach, JointLimit, Singularity, Collision, Jump };

/// Why there is no path.
struct Blockage {
  Obstacle what{Obstacle::None};
  double arc_mm{0};  ///< of the first tool point that no path gets past
  std::string detail;
};

struct JointPathResult {
  std::optional<JointPath> path;
  Blockage blockage;
};

struct JointPathOptions {
  double knot_spacing_mm{8};       ///< the search's grid along the path
  int turns{36};                   ///< and about the tool's axis, over its whole freedom
  double least_singularity{0.05};  ///< kinematics::Singularity::worst() that is still gone through
  double least_clearance_mm{2};
  std::optional<kinematics::Joints> near_rad{};  ///< the path had better begin near to this posture; finite
};

/// Dynamic programming over (knot, free turn, branch): the cheapest continuous way through the allowed
/// states; between the knots the turn is smoothed and every tool point solved next to its neighbour.  Cost:
/// some 10 ms nominal, parallel over knots.
[[nodiscard]] JointPathResult find_joint_path(const kinematics::ArmModel& arm, const ToolPath& path,
                                              const Tool& tool, const CollisionModel& collisions,
                                              const JointPathOptions& options);

}  // namespace biteline::path
