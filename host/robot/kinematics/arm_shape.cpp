// SPDX-License-Identifier: MIT
#include "host/robot/kinematics/arm_shape.hpp"

namespace biteline::kinematics {

std::array<LinkCapsule, k_link_capsules> link_capsules(const ArmModel& arm) {
  const DhLengths& d = arm.nominal;
  const LinkShape& s = arm.shape;
  const double wrist_mm = d.d4_mm - s.elbow_offset_mm;
  // Joint frames: z along the joint's axis; the links stand beside the axes by the two offsets.
  return {{
      {"base", -1, {{0, 0, 0}, {0, 0, 0.5 * d.d1_mm}, s.base_radius_mm}},
      {"shoulder", 0, {{0, 0, 0}, {0, -s.shoulder_offset_mm, 0}, s.upper_arm_radius_mm}},
      {"upper arm",
       1,
       {{0, 0, s.shoulder_offset_mm}, {d.a2_mm, 0, s.shoulder_offset_mm}, s.upper_arm_radius_mm}},
      {"elbow", 2, {{0, 0, s.shoulder_offset_mm}, {0, 0, s.elbow_offset_mm}, s.forearm_radius_mm}},
      {"forearm", 2, {{0, 0, s.elbow_offset_mm}, {d.a3_mm, 0, s.elbow_offset_mm}, s.forearm_radius_mm}},
      {"wrist 1", 3, {{0, 0, -wrist_mm}, {0, 0, 0}, s.wrist_radius_mm}},
      {"wrist 2", 4, {{0, 0, -d.d5_mm}, {0, 0, 0}, s.wrist_radius_mm}},
      {"wrist 3", 5, {{0, 0, -d.d6_mm}, {0, 0, -s.wrist_radius_mm}, s.wrist_radius_mm}},
  }};
}

std::array<Capsule, k_link_capsules> placed(const std::array<LinkCapsule, k_link_capsules>& links,
                                            const std::array<SE3, k_joints>& T_base_joint) {
  std::array<Capsule, k_link_capsules> out;
  for (std::size_t i = 0; i < k_link_capsules; ++i) {
    const SE3 T =
        links[i].joint < 0 ? SE3::Identity() : T_base_joint[static_cast<std::size_t>(links[i].joint)];
    out[i] = {
        .a = T * links[i].capsule.a, .b = T * links[i].capsule.b, .radius_mm = links[i].capsule.radius_mm};
  }
  return out;
}

}  // namespace biteline::kinematics
