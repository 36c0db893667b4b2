// SPDX-License-Identifier: MIT
#include "host/robot/kinematics/chain.hpp"

#include <cmath>

namespace biteline::kinematics {
namespace {

/// T * Rz(angle), without a full product.
SE3 turned(const SE3& T, double angle_rad) {
  const double c = std::cos(angle_rad), s = std::sin(angle_rad);
  SE3 out = T;
  out.matrix().col(0).head<3>() = c * T.matrix().col(0).head<3>() + s * T.matrix().col(1).head<3>();
  out.matrix().col(1).head<3>() = c * T.matrix().col(1).head<3>() - s * T.matrix().col(0).head<3>();
  return out;
}

}  // namespace

std::array<SE3, k_joints> joint_frames(const ArmModel& arm, const Joints& q_rad) {
  std::array<SE3, k_joints> frames;
  SE3 T = SE3::Identity();
  for (std::size_t i = 0; i < k_joints; ++i) {
    T = turned(T * arm.T_fixed[i], q_rad[static_cast<Eigen::Index>(i)]);
    frames[i] = T;
  }
  return frames;
}

SE3 forward(const ArmModel& arm, const Joints& q_rad) {
  return joint_frames(arm, q_rad).back();
}

Jacobian jacobian(const ArmModel& arm, const Joints& q_rad, const Vec3& point_base) {
  // A joint turns about its own z; Rz(q) leaves that axis where it is.
  const std::array<SE3, k_joints> frames = joint_frames(arm, q_rad);
  Jacobian J;
  for (std::size_t i = 0; i < k_joints; ++i) {
    const Vec3 axis_base = frames[i].linear().col(2);
    const auto column = static_cast<Eigen::Index>(i);
    J.col(column).head<3>() = axis_base.cross(point_base - frames[i].translation());
    J.col(column).tail<3>() = axis_base;
  }
  return J;
}

const char* Singularity::worst_name() const {
  if (worst() == wrist) return "wrist (axes 4 and 6 parallel)";
  if (worst() == elbow) return "elbow (arm stretched or folded)";
  return "shoulder (wrist over the base axis)";
}

Singularity singularity(const ArmModel& arm, const Joints& q_rad) {
  return singularity(arm, q_rad, joint_frames(arm, q_rad));
}

Singularity singularity(const ArmModel& arm, const Joints& q_rad,
                        const std::array<SE3, k_joints>& T_base_joint) {
  const Vec3 wrist_base = T_base_joint[4].translation();
  const double radius_mm = std::hypot(wrist_base.x(), wrist_base.y());
  const double inner_mm = arm.nominal.d4_mm;
  const double reach_mm = std::abs(arm.nominal.a2_mm) + std::abs(arm.nominal.a3_mm);
  return {.shoulder =
              std::min(1.0, std::sqrt(std::max(0.0, radius_mm * radius_mm - inner_mm * inner_mm)) / reach_mm),
          .elbow = std::abs(std::sin(q_rad[2])),
          .wrist = std::abs(std::sin(q_rad[4]))};
}

}  // namespace biteline::kinematics
