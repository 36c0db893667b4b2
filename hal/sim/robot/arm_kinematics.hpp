// SPDX-License-Identifier: MIT
#pragma once
/// \file Joint angles of the simulated arm: just enough kinematics for a controller that reports them.

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "common/geometry/se3.hpp"

namespace biteline::sim {

using JointVector = Eigen::Matrix<double, 6, 1>;  ///< rad, base to wrist 3

/// What the joints may do: turn by so much either way, so fast.
struct JointLimits {
  JointVector most_rad;
  JointVector speed_rad_s;
  JointVector acceleration_rad_s2;
};

/// Where the links stand beside the joints' axes, and how thick they are.
struct LinkShape {
  double shoulder_offset_mm;  ///< upper arm beside the shoulder's axis, along joint 2
  double elbow_offset_mm;     ///< forearm, likewise
  double base_radius_mm;
  double upper_arm_radius_mm;
  double forearm_radius_mm;
  double wrist_radius_mm;
};

/// A UR arm of nominal dimensions (Universal Robots, "DH parameters for calculations of kinematics"), or one
/// of its own.
class ArmKinematics {
 public:
  /// From a joint's frame to the next one: Rz(q + theta) Tz(d) Tx(a) Rx(alpha).
  struct DhRow {
    double a_mm, d_mm, alpha_rad, theta_rad{0};
  };
  /// ur3e, ur5e, ur10e; nothing for other names.
  [[nodiscard]] static std::optional<ArmKinematics> named(std::string_view name);

  /// One arm as it leaves the factory: its rows off the nominal ones, so that its flange is some 2 mm beside
  /// the nominal arm's at the same joints, as two published calibrations have it.  Seed 0: the nominal arm.
  [[nodiscard]] ArmKinematics made(std::uint64_t seed) const;
  /// As its controller tells them.
  [[nodiscard]] const std::array<DhRow, 6>& rows() const { return rows_; }

  [[nodiscard]] SE3 T_base_flange(const JointVector& q_rad) const;
  /// The frames that turn with the joints: z along the axis, where the link behind it begins.
  [[nodiscard]] std::array<SE3, 6> T_base_joints(const JointVector& q_rad) const;
  [[nodiscard]] const JointLimits& limits() const { return limits_; }
  [[nodiscard]] const LinkShape& shape() const { return shape_; }
  /// Along its x in the frame of its joint, negative: upper arm and forearm.
  [[nodiscard]] double upper_arm_mm() const { return rows_[1].a_mm; }
  [[nodiscard]] double forearm_mm() const { return rows_[2].a_mm; }
  /// Between the joints' axes, base to flange: d of the table of dimensions.
  [[nodiscard]] double d_mm(std::size_t joint) const { return rows_[joint].d_mm; }

  /// The joints near `q_near_rad` that reach the pose, by damped Newton steps to 1e-4 mm and 1e-7 rad;
  /// nothing when there are none near (out of reach, another branch, singular).
  [[nodiscard]] std::optional<JointVector> joints_near(const SE3& T_base_flange,
                                                       const JointVector& q_near_rad) const;

  /// As joints_near(), from a handful of common postures; for when nothing is known of where the arm was.
  [[nodiscard]] std::optional<JointVector> joints_anywhere(const SE3& T_base_flange) const;

 private:
  using Jacobian = Eigen::Matrix<double, 6, 6>;
  ArmKinematics(const std::array<DhRow, 6>& rows, const JointLimits& limits, const LinkShape& shape)
      : rows_(rows), limits_(limits), shape_(shape) {}
  /// Flange pose, and how it moves with each joint: [translation; rotation] in base.
  SE3 forward(const JointVector& q_rad, Jacobian& J) const;

  std::array<DhRow, 6> rows_;
  JointLimits limits_;
  LinkShape shape_;
};

}  // namespace biteline::sim
