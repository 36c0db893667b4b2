// SPDX-License-Identifier: MIT
#include "hal/sim/robot/arm_body.hpp"

#include <algorithm>

namespace biteline::sim {

double between_mm(const Capsule& one, const Capsule& other) {
  // Closest points of two segments: Ericson, "Real-Time Collision Detection", 5.1.9.
  const Vec3 d1 = one.b - one.a, d2 = other.b - other.a, r = one.a - other.a;
  const double a = d1.squaredNorm(), e = d2.squaredNorm(), f = d2.dot(r), c = d1.dot(r), b = d1.dot(d2);
  const auto part = [](double above, double below) {
    return below > 1e-12 ? std::clamp(above / below, 0.0, 1.0) : 0.0;
  };
  double s = part(b * f - c * e, a * e - b * b);
  const double t = part(b * s + f, e);
  s = part(b * t - c, a);
  return (one.a + s * d1 - other.a - t * d2).norm() - one.radius_mm - other.radius_mm;
}

std::array<NamedCapsule, k_arm_capsules> arm_body(const ArmKinematics& arm, const JointVector& q_rad) {
  const std::array<SE3, 6> T = arm.T_base_joints(q_rad);
  const LinkShape& s = arm.shape();
  const auto link = [](const SE3& T_base, const Vec3& from, const Vec3& to, double radius_mm) {
    return Capsule{.a = T_base * from, .b = T_base * to, .radius_mm = radius_mm};
  };
  const double so = s.shoulder_offset_mm, eo = s.elbow_offset_mm;
  const Vec3 none = Vec3::Zero();
  return {{
      {"base", link(SE3::Identity(), none, {0, 0, 0.5 * arm.d_mm(0)}, s.base_radius_mm)},
      {"shoulder", link(T[0], none, {0, -so, 0}, s.upper_arm_radius_mm)},
      {"upper arm", link(T[1], {0, 0, so}, {arm.upper_arm_mm(), 0, so}, s.upper_arm_radius_mm)},
      {"elbow", link(T[2], {0, 0, so}, {0, 0, eo}, s.forearm_radius_mm)},
      {"forearm", link(T[2], {0, 0, eo}, {arm.forearm_mm(), 0, eo}, s.forearm_radius_mm)},
      {"wrist 1", link(T[3], {0, 0, eo - arm.d_mm(3)}, none, s.wrist_radius_mm)},
      {"wrist 2", link(T[4], {0, 0, -arm.d_mm(4)}, none, s.wrist_radius_mm)},
      {"wrist 3", link(T[5], {0, 0, -arm.d_mm(5)}, {0, 0, -s.wrist_radius_mm}, s.wrist_radius_mm)},
  }};
}

}  // namespace biteline::sim
