// SPDX-License-Identifier: MIT
#pragma once
/// \file Why an arm that follows a path is stopped, or its run is not a done job.

#include "host/report/refusal.hpp"

namespace biteline::robot {

enum class Halt {
  OffPath,         ///< the tip is beside the planned way
  OffDirection,    ///< the tool points elsewhere
  OffWay,          ///< a joint is beside the way to the path's beginning
  OtherTool,       ///< the controller reckons with another tool than the plan
  Late,            ///< behind or ahead of the plan
  Stalled,         ///< the program runs and the tip stands
  NotCovered,      ///< the program ended and part of the line was left out
  Silent,          ///< no new state: link lost, or the controller frozen
  Unusable,        ///< a state without numbers
  ProtectiveStop,  ///< the controller's own safety holds the arm
  PowerOff,        ///< power or brakes went
  LocalControl,    ///< somebody at the pendant has taken the arm
  NotStarted,      ///< the program did not begin
  NotEnded,        ///< the program did not end in any time it could need
  Person,          ///< the service was told to stop
  Old,             ///< states come, and show what was
  NotSent,         ///< the program did not leave whole: what the controller has of it is not known
  ToolOn,          ///< the run is over, and the tool's output is not seen off
  ProgramError,    ///< the controller does not take the program, or ended it for a fault in it
  NoContact,       ///< the tool did not touch the shoe within the process's reach
  ContactLost,     ///< it touched, and does not any more
  ForceTooHigh,    ///< it presses harder than the process allows
  ForceOff,        ///< arm or flange do not come to the set force
  FlangeDead,      ///< the flange that presses is not ready any more, or has no force
  StopDoorClosed,  ///< a stop could not switch the tool off: nothing can be sent
};

[[nodiscard]] std::span<const report::RefusalRow<Halt>> refusal_table(Halt);

using HaltReason = report::Refusal<Halt>;

}  // namespace biteline::robot
