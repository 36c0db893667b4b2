// SPDX-License-Identifier: MIT
#pragma once
/// \file The border to the UR controller's units: metres and rotation vectors there, mm and matrices here.

#include <array>

#include "common/geometry/se3.hpp"

namespace biteline::robot::ur {

constexpr double k_mm_per_m = 1000;

/// p[x, y, z, rx, ry, rz] in m and rad, as URScript and RTDE have it.
[[nodiscard]] inline std::array<double, 6> to_ur_pose(const SE3& T) {
  const Vec3 p = T.translation() / k_mm_per_m;
  const Vec3 r = geometry::log_so3(T.linear());
  return {p.x(), p.y(), p.z(), r.x(), r.y(), r.z()};
}

[[nodiscard]] inline SE3 from_ur_pose(const std::array<double, 6>& pose) {
  SE3 T = SE3::Identity();
  T.translation() = Vec3{pose[0], pose[1], pose[2]} * k_mm_per_m;
  T.linear() = geometry::exp_so3(Vec3{pose[3], pose[4], pose[5]});
  return T;
}

}  // namespace biteline::robot::ur
