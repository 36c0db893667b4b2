// SPDX-License-Identifier: MIT
#pragma once
/// \file The arm's body as capsules, for what it may not touch.

#include <array>

#include "hal/sim/robot/arm_kinematics.hpp"

namespace biteline::sim {

/// All points within `radius_mm` of the segment from a to b.
struct Capsule {
  Vec3 a{Vec3::Zero()};
  Vec3 b{Vec3::Zero()};
  double radius_mm{0};
};

/// Free space between two; negative: they touch.
[[nodiscard]] double between_mm(const Capsule& one, const Capsule& other);

struct NamedCapsule {
  const char* name;
  Capsule capsule;  ///< in base
};
inline constexpr std::size_t k_arm_capsules = 8;

/// Base, shoulder, upper arm, elbow, forearm, wrist 1, 2, 3.
[[nodiscard]] std::array<NamedCapsule, k_arm_capsules> arm_body(const ArmKinematics& arm,
                                                                const JointVector& q_rad);

}  // namespace biteline::sim
