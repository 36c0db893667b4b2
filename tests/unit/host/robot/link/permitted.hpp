// SPDX-License-Identifier: MIT
#pragma once
/// \file A path let through by the gate, for tests of what comes after it.

#include "host/robot/link/gate/gate.hpp"

namespace biteline::robot::test {

/// Everything as it should be: each row passes, or is not known and not asked for.
inline GateInputs good_inputs(const kinematics::Joints& q_rad = kinematics::Joints::Zero()) {
  GateInputs inputs;
  inputs.scan = {.name = "scan-0001", .scan_id = 7, .one_connection = true, .age_s = 3, .lost = {}};
  inputs.result = {.line_passed = true, .path_passed = true, .way_clearance_mm = 50, .same_payload = true};
  inputs.arm = {.arm = "UR5e",
                .told_version = "URSoftware 5.12.0.0",
                .told_model = "UR5",
                .told_remote = true,
                .q_checked_rad = q_rad,
                .q_now_rad = q_rad,
                .held = true};
  return inputs;
}

/// Of a cell that nobody stops.
inline const Stops& no_stops() {
  static const Stops k_stops;
  return k_stops;
}

/// To an arm that stands at `q_rad`.
inline PermittedPath permitted(const path::CheckedPath& path,
                               const kinematics::Joints& q_rad = kinematics::Joints::Zero(),
                               const StopMark& mark = no_stops().now()) {
  return *open_gate(good_inputs(q_rad), path, mark).path;
}

}  // namespace biteline::robot::test
