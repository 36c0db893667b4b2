// SPDX-License-Identifier: MIT
#pragma once
/// \file Orocos KDL, the kinematics library of ROS, on the same arm.

#include <memory>
#include <optional>

#include "host/robot/kinematics/arm_model.hpp"

namespace biteline::bench::peers {

[[nodiscard]] bool has_kdl();

/// KDL's Levenberg-Marquardt inverse: one solution from a starting guess.
class KdlInverse {
 public:
  explicit KdlInverse(const kinematics::ArmModel& arm);
  ~KdlInverse();
  [[nodiscard]] std::optional<kinematics::Joints> solve(const SE3& T_base_flange,
                                                        const kinematics::Joints& guess_rad);

 private:
  struct Solver;
  std::unique_ptr<Solver> solver_;
};

}  // namespace biteline::bench::peers
