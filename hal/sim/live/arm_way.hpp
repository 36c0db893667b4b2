// SPDX-License-Identifier: MIT
#pragma once
/// \file A scan as an arm with dynamics makes it, without running time.

#include "hal/sim/live/arm_scan.hpp"
#include "hal/sim/record/session_recorder.hpp"
#include "hal/sim/robot/joint_dynamics.hpp"

namespace biteline::sim {

/// Time 0 is where the scan proper begins; the arm sets out from rest before it.
[[nodiscard]] HeadWay way_of(const ArmScan& scan, const ArmKinematics& kinematics,
                             const ArmDynamics& dynamics);

}  // namespace biteline::sim
