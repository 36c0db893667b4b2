// SPDX-License-Identifier: MIT
#pragma once
/// \file How fast: speed and time at every tool point.

#include <vector>

#include "host/robot/path/joint_path.hpp"

namespace biteline::path {

struct Timing {
  std::vector<double> speed_mm_s;  ///< of the tip, 0 where it stops
  std::vector<double> time_s;
  /// Of the move to each point; empty: the process's, and the controller makes its ramps as it likes.
  std::vector<double> acceleration_mm_s2{};
};

/// The fastest speeds within the process's and the joints' limits: per point by curvature and joint speed,
/// then along the path by acceleration, forwards and back (Bobrow, Dubowsky, Gibson 1985, with constant
/// acceleration).  The tip stops where the kind of segment changes and where a straight way bends.
/// Straight ways beside the line as a controller drives them: each at one speed, the slowest that any place
/// of it allows, and as soon as the acceleration lets the tip.
[[nodiscard]] Timing time_path(const kinematics::ArmModel& arm, const ToolPath& path, const JointPath& joints,
                               const Motion& motion);

/// Largest joint acceleration over its limit, and where.
struct JointAcceleration {
  double ratio{0};
  double arc_mm{0};
  int joint{0};
};
[[nodiscard]] JointAcceleration worst_acceleration(const kinematics::ArmModel& arm, const ToolPath& path,
                                                   const JointPath& joints, const Timing& timing);

}  // namespace biteline::path
