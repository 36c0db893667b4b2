// SPDX-License-Identifier: MIT
#include "host/robot/kinematics/dh_rows.hpp"

#include <cmath>

#include "host/robot/kinematics/calibration.hpp"

namespace biteline::kinematics {
namespace {

/// The flange is the frame behind joint 6: nothing of a row is left there.
constexpr double k_flange_mm = 1e-6, k_flange_rad = 1e-9;

SE3 behind_joint(const DhRow& row) {
  SE3 T = SE3::Identity();
  T.translation().x() = row.a_mm;
  T.linear() = Eigen::AngleAxisd(row.alpha_rad, Vec3::UnitX()).toRotationMatrix();
  return T;
}

SE3 along_axis(double way_mm, double turn_rad) {
  SE3 T = SE3::Identity();
  T.translation().z() = way_mm;
  T.linear() = Eigen::AngleAxisd(turn_rad, Vec3::UnitZ()).toRotationMatrix();
  return T;
}

}  // namespace

Result<ArmModel> with_rows(const ArmModel& arm, const std::array<DhRow, k_joints>& rows,
                           const std::string& where) {
  const DhRow& last = rows.back();
  if (!(std::abs(last.a_mm) <= k_flange_mm && std::abs(last.alpha_rad) <= k_flange_rad))
    return fail(Errc::BadValue, "%.100s: its last row turns or moves the flange", where.c_str());
  ArmModel calibrated = arm;
  // A way along a joint's axis may stand before its turn or behind it.  Each joint's frame is put where its
  // part along the axis is the nominal one, and the rest goes on to the next.
  double carried_mm = 0;
  for (std::size_t i = 0; i < k_joints; ++i) {
    const SE3 before = i == 0 ? SE3::Identity() : along_axis(carried_mm, 0) * behind_joint(rows[i - 1]);
    SE3 T = before * along_axis(rows[i].d_mm, rows[i].theta_rad);
    carried_mm = 0;
    if (i == 1 || i == 2) {
      // Along the joint's own axis, until it is as high in the frame before as nominally: 0.
      const Vec3 axis = T.linear().col(2);
      carried_mm = i == 1 ? rows[i].d_mm : T.translation().z() / axis.z();
      T.translation() -= carried_mm * axis;
    }
    calibrated.T_fixed[i] = T;
  }
  BITELINE_TRY(expect_near_nominal(calibrated, where));
  calibrated.calibrated = true;
  return calibrated;
}

}  // namespace biteline::kinematics
