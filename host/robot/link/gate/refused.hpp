// SPDX-License-Identifier: MIT
#pragma once
/// \file Why the gate lets no path through.

#include "host/report/refusal.hpp"

namespace biteline::robot {

enum class Refused {
  ScanNotSeen,         ///< recovered or of a recording, and no person vouches for it
  ScanTooOld,          ///< the shoe may have been moved since
  ShoeMoved,           ///< a look after the scan shows it
  OtherShoe,           ///< the look shows another one
  OtherConnection,     ///< the sensor was lost in mid-scan
  PicturesNotVouched,  ///< nobody vouches that they are as the head was calibrated
  SentBefore,          ///< this scan's path was sent already
  Stopped,             ///< by a person, since the scan was ordered
  MessagesLost,        ///< profiles never came
  HolesInScan,         ///< frames, profiles or edges lost in a row
  LineNotPassed,       ///< no line that passed its checks
  PathNotPassed,       ///< no path, or no free way to it
  TooUncertain,        ///< the line's uncertainty is beyond the tolerance
  TipTooFar,           ///< the tool's tip may be farther off the line than the process takes
  NotApproved,         ///< a person has said no, or has not said yes where the process asks
  ToolNotMounted,      ///< the process names another tool than the one that is mounted
  NotAsTaught,         ///< tip, payload or table are not what was taught at the cell
  FilesChanged,        ///< line, cloud, report or process is not what the service wrote and planned with
  ArmMoved,            ///< since its way was checked
  NotRemote,           ///< the controller is in local control
  OtherArm,            ///< not the configured model
  OtherSerial,         ///< not the configured arm
  OtherTool,           ///< the path is planned for another tool than the process's
  OtherPayload,        ///< the path carries another payload than the process's
  ArmNotHeld,          ///< another service may send, too
};

[[nodiscard]] std::span<const report::RefusalRow<Refused>> refusal_table(Refused);

}  // namespace biteline::robot
