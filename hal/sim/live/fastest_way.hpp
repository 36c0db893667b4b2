// SPDX-License-Identifier: MIT
#pragma once
/// \file How fast a given way of the joints may be gone, from rest to rest.

#include <vector>

#include "hal/sim/robot/arm_kinematics.hpp"

namespace biteline::sim {

struct WayLimits {
  JointLimits joints;
  double speed_mm_s;             ///< along the way
  double acceleration_mm_s2;     ///< likewise
  std::vector<double> slower{};  ///< at each sample: the joints take it slower by this; empty: nowhere
};

/// The speed at each sample, mm/s, of the quickest time law (Pham and Pham, "A new approach to time-optimal
/// path parameterization based on reachability analysis", 2018).  A joint's acceleration is what the way's
/// bend asks for at that speed and what the change of speed does, together.  Pre: three samples or more,
/// `step_mm` apart.
[[nodiscard]] std::vector<double> fastest_way(const std::vector<JointVector>& q_rad, double step_mm,
                                              const WayLimits& limits);

}  // namespace biteline::sim
