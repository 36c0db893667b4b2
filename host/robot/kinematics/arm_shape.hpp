// SPDX-License-Identifier: MIT
#pragma once
/// \file The arm's body as capsules, for collisions and for drawing.

#include "host/robot/kinematics/arm_model.hpp"

namespace biteline::kinematics {

/// All points within `radius_mm` of the segment from `a` to `b`.
struct Capsule {
  Vec3 a;
  Vec3 b;
  double radius_mm;
};

/// One capsule of the arm: fixed in the frame of joint `joint`, 0 to 5; -1 is the base.
struct LinkCapsule {
  const char* name;
  int joint;
  Capsule capsule;
};

constexpr std::size_t k_link_capsules = 8;

/// From base to wrist 3.
[[nodiscard]] std::array<LinkCapsule, k_link_capsules> link_capsules(const ArmModel& arm);

/// The capsules in base, with the arm at `q_rad`.
[[nodiscard]] std::array<Capsule, k_link_capsules> placed(
    const std::array<LinkCapsule, k_link_capsules>& links, const std::array<SE3, k_joints>& T_base_joint);

}  // namespace biteline::kinematics
