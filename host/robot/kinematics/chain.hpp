// SPDX-License-Identifier: MIT
#pragma once
/// \file From joints to poses and speeds.

#include <algorithm>

#include "host/robot/kinematics/arm_model.hpp"

namespace biteline::kinematics {

/// T_base_flange; the flange is the frame after joint 6, z out of the plate.
[[nodiscard]] SE3 forward(const ArmModel& arm, const Joints& q_rad);

/// T_base_joint of every joint, turned by its angle; the last is the flange.
[[nodiscard]] std::array<SE3, k_joints> joint_frames(const ArmModel& arm, const Joints& q_rad);

using Jacobian = Eigen::Matrix<double, 6, 6>;

/// [speed of the point p, mm/s; turning speed, rad/s], both in base, per joint speed; p is fixed in the
/// flange and stands at `point_base` now.
[[nodiscard]] Jacobian jacobian(const ArmModel& arm, const Joints& q_rad, const Vec3& point_base);

/// How close to the three places where a UR arm loses a degree of freedom; each 0 at the singularity, at
/// most 1.
struct Singularity {
  double shoulder;  ///< wrist centre over the base axis: its distance outside the arm's inner cylinder, over
                    ///< the reach
  double elbow;     ///< arm stretched or folded: |sin q3|
  double wrist;     ///< axes 4 and 6 parallel: |sin q5|
  [[nodiscard]] double worst() const { return std::min({shoulder, elbow, wrist}); }
  [[nodiscard]] const char* worst_name() const;
};
[[nodiscard]] Singularity singularity(const ArmModel& arm, const Joints& q_rad);
/// The same where the frames of these joints are known.
[[nodiscard]] Singularity singularity(const ArmModel& arm, const Joints& q_rad,
                                      const std::array<SE3, k_joints>& T_base_joint);

}  // namespace biteline::kinematics
