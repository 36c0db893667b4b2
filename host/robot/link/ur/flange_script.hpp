// SPDX-License-Identifier: MIT
#pragma once
/// \file The part of a path's program that presses by a constant-force flange: the arm keeps its path, a
/// thread commands the flange by the controller's lines.
///
///     press:  0        3                1           2                 0
///             off      on, touch force  at the line  along the line   off
///                      on the way in    waits        force by place

#include <string>

#include "host/robot/link/ur/force_script.hpp"

namespace biteline::robot::ur {

/// The thread, started, under the names and words of force_thread(); pre: the path presses, by a flange.
/// Each cycle it takes the force from the tip's way and gives it to the analog output.  Its own looks end the
/// program, the outputs off: not ready at the line's beginning (no contact), not ready for `lost_s` on its
/// way or a reading below half of the set force for as long (the flange is dead), too high a reading.
[[nodiscard]] std::string flange_thread(const path::PlannedPath& path, const ToolOutputs& outputs);
/// Before the last step of the way in, beside the shoe: the tool comes out with the touch's force.
[[nodiscard]] std::string flange_out();
/// Before a run's moves, while the tool stands at its beginning.  `way_mm`: of the tip over the runs before.
[[nodiscard]] std::string flange_begins(const path::PlannedPath& path, double way_mm);

}  // namespace biteline::robot::ur
