// SPDX-License-Identifier: MIT
#pragma once
/// \file Joint angles of the simulated arm: just enough kinematics for a controller that reports them.

#include <array>
#include <optional>
#include <string_view>

#include "common/geometry/se3.hpp"

namespace biteline::sim {

using JointVector = Eigen::Matrix<double, 6, 1>;  ///< rad, base to wrist 3

/// A UR arm of nominal dimensions (Universal Robots, "DH parameters for calculations of kinematics").
class ArmKinematics {
 public:
  /// ur3e, ur5e, ur10e; nothing for other names.
  [[nodiscard]] static std::optional<ArmKinematics> named(std::string_view name);

  [[nodiscard]] SE3 T_base_flange(const JointVector& q_rad) const;

  /// The joints near `q_near_rad` that reach the pose, by damped Newton steps to 1e-4 mm and 1e-7 rad;
  /// nothing when there are none near (out of reach, another branch, singular).
  [[nodiscard]] std::optional<JointVector> joints_near(const SE3& T_base_flange,
                                                       const JointVector& q_near_rad) const;

  /// As joints_near(), from a handful of common postures; for when nothing is known of where the arm was.
  [[nodiscard]] std::optional<JointVector> joints_anywhere(const SE3& T_base_flange) const;

 private:
  struct DhRow {
    double a_mm, d_mm, alpha_rad;
  };
  using Jacobian = Eigen::Matrix<double, 6, 6>;
  explicit ArmKinematics(const std::array<DhRow, 6>& rows) : rows_(rows) {}
  /// Flange pose, and how it moves with each joint: [translation; rotation] in base.
  SE3 forward(const JointVector& q_rad, Jacobian& J) const;

  std::array<DhRow, 6> rows_;
};

}  // namespace biteline::sim
