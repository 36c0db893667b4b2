// SPDX-License-Identifier: MIT
#pragma once
/// \file The arms: nominal dimensions, calibrated frames, limits.

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "common/core/result.hpp"
#include "common/geometry/se3.hpp"

namespace biteline::kinematics {

constexpr std::size_t k_joints = 6;
using Joints = Eigen::Matrix<double, 6, 1>;  ///< rad, from base to wrist 3

/// Denavit-Hartenberg lengths of the UR family; twists are pi/2, 0, 0, pi/2, -pi/2, 0 for all of them.
struct DhLengths {
  double d1_mm;
  double a2_mm;
  double a3_mm;
  double d4_mm;
  double d5_mm;
  double d6_mm;
};

/// Where the links stand beside the joint axes; the kinematics do not show it, collisions do.
struct LinkShape {
  double shoulder_offset_mm;  ///< upper arm beside the shoulder's axis, along joint 2
  double elbow_offset_mm;     ///< forearm, likewise
  double base_radius_mm;
  double upper_arm_radius_mm;
  double forearm_radius_mm;
  double wrist_radius_mm;
};

struct JointLimits {
  Joints minimum_rad;
  Joints maximum_rad;
  Joints speed_rad_s;
  Joints acceleration_rad_s2;
};

/// How the joints give: links hang on their drives by springs.
struct JointGive {
  Joints natural_hz;           ///< of each joint, with what it carries
  double damping_ratio{0.05};  ///< a shaken arm is at rest again after a dozen swings
  bool measured{false};        ///< on this arm; else assumed
};

/// What an arm's controller says of itself.
struct Controller {
  const char* says{""};  ///< the model's name, without the series: "UR5" of a UR5, a UR5e and a UR7e
  bool cb3{false};       ///< software 3; else 5 or PolyScope X
};

struct ArmModel {
  std::string name;
  Controller controller{};
  DhLengths nominal;
  /// Fixed part of each joint's frame in the one before: T_previous_joint = T_fixed * Rz(q).  Nominal until a
  /// factory calibration is applied.
  std::array<SE3, k_joints> T_fixed;
  bool calibrated{false};
  JointLimits limits;
  LinkShape shape;
  JointGive give;
};

/// Of a softest joint that has `softest_hz`: the shoulder carries most, the last wrist the tool alone.
[[nodiscard]] JointGive joint_give(double softest_hz, bool measured);

/// UR3e UR5e UR7e UR10e UR12e UR16e UR20 UR30 UR3 UR5 UR10, upper or lower case.
[[nodiscard]] Result<ArmModel> arm_model(std::string_view name);
/// Its controller may say that name.  The software's generation is looked at beside it.
[[nodiscard]] bool is_told_as(const ArmModel& arm, std::string_view told);
/// Their names, with commas between.
[[nodiscard]] std::string known_arms();
[[nodiscard]] std::vector<std::string> arm_names();

/// The frames that follow from the lengths alone.
[[nodiscard]] std::array<SE3, k_joints> nominal_frames(const DhLengths& lengths);

}  // namespace biteline::kinematics
