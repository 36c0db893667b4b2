// SPDX-License-Identifier: MIT
#pragma once
/// \file The part of a path's program that lets the tool flow: a thread, and what the program tells it.

#include <string>
#include <string_view>

#include "host/robot/path/checks/program_check.hpp"

namespace biteline::robot::ur {

/// The tool's outputs on the controller's terminals.
struct ToolOutputs {
  int digital{-1};                       ///< of its gun; -1: none
  int analog{-1};                        ///< of its flow; -1: none
  int flange_on{-1}, flange_analog{-1};  ///< of a flange that presses; -1: none
};
[[nodiscard]] ToolOutputs outputs_of(const path::PlannedPath& path);
/// All off, as rows of a program.
[[nodiscard]] std::string outputs_off(const ToolOutputs& outputs, std::string_view indent = "  ");

/// Where the film of a run ends, for the thread.
struct FilmEnd {
  Vec3 spot_base{Vec3::Zero()};  ///< the place that is worked, mm
  double way_mm{0};              ///< of that place, from the run's beginning to it
};
/// Of a run on the line.  `closes`: it comes over its own beginning, and only film_overlap_mm of that get
/// film.
[[nodiscard]] FilmEnd film_end(const path::PlannedPath& path, const path::PathRun& run, bool closes);

/// Beside the shoe, while the tool stands there: both outputs full for the purge, and off until nothing comes
/// any more.  Before the thread, which would set them.
[[nodiscard]] std::string flow_purge(const path::PlannedPath& path);

/// The thread, started; pre: the path has a flow.  Each cycle it takes the speed of the place that is worked
/// (the tip's target, `standoff_mm` ahead along the tool) and
/// - sets the analog output to (v + lag dv/dt) / full, from 0 to 1: a first-order lag of the flow is undone
/// by
///   its own inverse (feed-forward by pole cancellation; Åström, Murray, "Feedback Systems", 2nd ed., 12.4),
///   until the gun is closed;
/// - switches the gun off `gun_off_s` before the film's end;
/// - switches it off while the place stands, as on a pause, and on again when it goes on.
[[nodiscard]] std::string flow_thread(const path::PlannedPath& path);
/// What comes before a run's moves, while the tool stands at its beginning: the gun goes on, and it waits.
[[nodiscard]] std::string flow_begins(const path::PlannedPath& path, const FilmEnd& end);
/// What comes after them.
[[nodiscard]] std::string flow_ends();

}  // namespace biteline::robot::ur
