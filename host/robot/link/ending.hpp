// SPDX-License-Identifier: MIT
#pragma once
/// \file How a run ends: the arm at rest and its tool off, both seen and never taken for granted.

#include "host/robot/link/robot_link.hpp"

namespace biteline::robot {

/// At its way's end an arm rings for some tenths of a second, at 8 to 20 Hz and by tenths of a millimetre. So
/// much of turn_rad and move_mm is enough to send a path: a ninth of what the gate lets an arm move between
/// the check of its way and the sending (path::GateLimits::start_rad), and 2 mm/s for an arm that creeps.
inline constexpr double k_ringing_rad = 4e-4, k_ringing_mm = 0.4;

/// The tool's output after a run, as the controller's states have it.
enum class ToolOutput {
  None,     ///< the path switches none
  Off,      ///< seen off
  On,       ///< STILL ON, though it was sent off again
  NotSeen,  ///< no states tell
};
[[nodiscard]] const char* name_of(ToolOutput tool);

struct Ending {
  bool at_rest{false};  ///< seen: no program runs, and the arm stands
  ToolOutput tool{ToolOutput::NotSeen};
  int stops{0};  ///< words that stop arm and tool, sent

  [[nodiscard]] bool tool_is_safe() const { return tool == ToolOutput::Off || tool == ToolOutput::None; }
  [[nodiscard]] bool seen() const { return at_rest && tool_is_safe(); }
};

struct EndingOptions {
  double rest_patience_s{2};      ///< from a stop to the arm at rest
  double output_patience_s{0.5};  ///< from a program's end or a stop to its output seen off
  double move_mm{k_ringing_mm};   ///< an arm that stands moves less in 0.1 s
  double turn_rad{k_ringing_rad};
  int digital_output{-1};  ///< that the path switches on; -1: none
  /// Above 0: for so long the program is left to its dead man before the stop's words leave.  Where a
  /// controller takes no program any more only the running one can switch the tool off, and the word that
  /// stops it ends its dead man, too.
  double dead_man_s{0};
};

/// Of a program that ended by itself: looks, and sends the stop where something is not as it should be.
[[nodiscard]] Ending end_run(RobotLink& link, const EndingOptions& options);
/// Of all others: the stop first, at once, then the looks; again where it came to nothing, since a word may
/// be lost. What then still moves or turns only a person can stop.
[[nodiscard]] Ending stop_run(RobotLink& link, const EndingOptions& options);

/// What a person must do now; empty: nothing.
[[nodiscard]] std::string alarm_of(const Ending& ending);

/// By both clocks: states that were held up tell little of the time in which they were awaited, and those
/// that then come at once are old.
[[nodiscard]] double between_s(const RobotState& begin, const RobotState& end);

}  // namespace biteline::robot
