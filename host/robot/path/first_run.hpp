// SPDX-License-Identifier: MIT
#pragma once
/// \file A path as it is tried first: in the air, slowly, with the tool off.

#include "host/robot/path/plan.hpp"

namespace biteline::path {

inline constexpr double k_first_run_lift_mm = 30;
/// A wall that leans out by 20 degrees (Outwards) stands 11 mm farther out at that height.
inline constexpr double k_first_run_out_mm = 30;
inline constexpr double k_first_run_speed_ratio = 0.1;
/// No speed of the tip becomes slower than this, or than the process has it: nobody needs it, and a line
/// would take a quarter of an hour.
inline constexpr double k_first_run_least_mm_s = 1;
/// Of the tip to the shoe: what is left beside such a wall, less half the spacing of the shoe's points.
inline constexpr double k_first_run_clear_mm = 10;

/// The same path k_first_run_lift_mm higher and k_first_run_out_mm farther out, every speed a tenth
/// (the way there as slow as the approach), the output switched off and never on, and refused where the tip
/// comes nearer to the shoe than k_first_run_clear_mm.  The limits of gate and following stay; only how long
/// the tip may stand is at least the usual, as it dwells on nothing.
[[nodiscard]] PlanRequest first_run(PlanRequest request);

inline constexpr double k_force_air_out_mm = 10;

/// Beside the shoe at the speed of the work, the tool off, nothing that presses: what the force sensor tells
/// there is its own error by the place (force_learning.hpp).  After a first run; so near that the sensor's
/// error is the same, and as far off as a line's uncertainty and a tool's unevenness allow.
[[nodiscard]] PlanRequest force_air_run(PlanRequest request);

}  // namespace biteline::path
