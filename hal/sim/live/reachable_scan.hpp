// SPDX-License-Identifier: MIT
#pragma once
/// \file A place for the shoe where the arm takes the head all the way round it.

#include <memory>
#include <string>

#include "hal/sim/live/arm_scan.hpp"
#include "hal/sim/record/made_scene.hpp"

namespace biteline::sim {

/// The scan as the arm makes it, and why the shoe stands elsewhere than asked for or the head goes higher.
struct ReachableScan {
  std::shared_ptr<const ArmScan> scan{};
  std::string moved_because{};  ///< empty: neither
};

/// Moves the scene's shoe until the arm reaches all the way round it.  Where no place does, the scan aims
/// higher by 10 and 20 mm: beside a low shoe the camera is near the table.  Errc::OutOfReach tells the first
/// place's reason, and the scene aims as before.
[[nodiscard]] Result<ReachableScan> place_within_reach(MadeScene& scene, const ArmKinematics& kinematics,
                                                       const std::string& arm);

}  // namespace biteline::sim
