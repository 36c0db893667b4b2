// SPDX-License-Identifier: MIT
#pragma once
/// \file The part of a path's program that presses: a thread with force mode, and what the program tells it.

#include <array>
#include <string>
#include <vector>

#include "host/robot/link/ur/flow_script.hpp"
#include "host/robot/path/checks/program_check.hpp"

namespace biteline::robot::ur {

/// Where the thread tells what it does: output_int_register_N, one of those that no fieldbus takes.
inline constexpr int k_force_register = 47;
/// What it tells there; all from Untouched on end the program.
enum class ForceWord : int {
  None = 0,
  Seeks = 1,
  Presses = 2,
  Untouched = 11,   ///< no contact within the process's reach
  Lost = 12,        ///< none any more
  TooHigh = 13,     ///< more than the process allows
  FlangeDead = 14,  ///< a flange that is not ready any more, or does not come to its force
};

/// Force and direction by the tip's way over all runs on the line, m: the waypoints where the direction has
/// turned by 0.05 rad, or the force has changed by a fiftieth, and all run ends.
struct ForceKnot {
  double way_m{0};
  std::array<double, 3> turn_rad{};  ///< rotation vector of a frame in base whose z is the direction
  double newton{0};
};
[[nodiscard]] std::vector<ForceKnot> force_knots(const path::PlannedPath& path);

/// The thread, started; pre: the path presses.  Each cycle it takes direction and force from the tip's way
/// and gives them to force_mode (Universal Robots, "The URScript Programming Language"): compliant along z of
/// a task frame in base, the wrench there, type 2.  Before it has touched the tip goes at the process's
/// approach speed.  Its own looks end the program, the outputs off: no touch within the reach, none any more,
/// too high a force.  The reading is taken through a first-order lag of 10 ms.
[[nodiscard]] std::string force_thread(const path::PlannedPath& path, const ToolOutputs& outputs);
/// Where the tool stands free before its way in: the sensor's zero.
[[nodiscard]] std::string force_zero();
/// What comes before a run's moves, while the tool stands at its beginning: force mode begins, with the
/// touch's force, and the program waits as long as a touch may take.  `way_mm`: of the tip over the runs
/// before.
[[nodiscard]] std::string force_begins(const path::PlannedPath& path, double way_mm);
/// What comes after them.
[[nodiscard]] std::string force_ends();

}  // namespace biteline::robot::ur
