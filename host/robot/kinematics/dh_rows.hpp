// SPDX-License-Identifier: MIT
#pragma once
/// \file An arm's own Denavit-Hartenberg rows, as its controller tells them.

#include <array>

#include "host/robot/kinematics/arm_model.hpp"

namespace biteline::kinematics {

/// From a joint's frame to the next one: Rz(q + theta) Tz(d) Tx(a) Rx(alpha), the makers' own convention.
///
/// The axes of joints 2, 3 and 4 are almost parallel, so that the common normal of two of them may lie
/// hundreds of metres away: `d` of those rows is then as large, and the three cancel.
struct DhRow {
  double theta_rad{0};
  double a_mm{0};
  double d_mm{0};
  double alpha_rad{0};
};

/// The arm with these rows in the place of the nominal ones.  Errc::BadValue: a joint stands further from the
/// nominal model than any arm of that kind does, or the last row turns the flange (rows of another arm).
/// `where`: names the source in the message.
[[nodiscard]] Result<ArmModel> with_rows(const ArmModel& arm, const std::array<DhRow, k_joints>& rows,
                                         const std::string& where);

}  // namespace biteline::kinematics
