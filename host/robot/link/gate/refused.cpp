// SPDX-License-Identifier: MIT
#include "host/robot/link/gate/refused.hpp"

#include <array>

namespace biteline::robot {

std::span<const report::RefusalRow<Refused>> refusal_table(Refused) {
  using Row = report::RefusalRow<Refused>;
  constexpr const char* k_again = "scan the shoe again";
  static constexpr std::array k_rows{
      Row{Refused::ScanNotSeen, "scan_not_seen",
          "look whether the shoe still stands so, then --confirm the scan"},
      Row{Refused::ScanTooOld, "scan_too_old", k_again},
      Row{Refused::ShoeMoved, "shoe_moved", k_again},
      Row{Refused::OtherShoe, "other_shoe", "scan the shoe that stands there now"},
      Row{Refused::OtherConnection, "other_connection", k_again},
      Row{Refused::PicturesNotVouched, "pictures_not_vouched",
          "calibrate the head anew, which stores its camera's state, or scan with a check lap"},
      Row{Refused::SentBefore, "sent_before", k_again},
      Row{Refused::Stopped, "stopped_by_a_person", "start, then scan the shoe again"},
      Row{Refused::MessagesLost, "messages_lost", k_again},
      Row{Refused::HolesInScan, "holes_in_scan", "scan again, slower or on a quieter machine"},
      Row{Refused::LineNotPassed, "line_not_passed", "see the scan's report.json"},
      Row{Refused::PathNotPassed, "path_not_passed", "see the path's report.json"},
      Row{Refused::TooUncertain, "too_uncertain", "scan again, or ask the process for less"},
      Row{Refused::TipTooFar, "tip_too_far", "teach the tip again, scan again, or let the arm give less"},
      Row{Refused::NotApproved, "not_approved", "look at the result, then --confirm the scan"},
      Row{Refused::ToolNotMounted, "tool_not_mounted", "mount the process's tool, then say so on its page"},
      Row{Refused::NotAsTaught, "not_as_taught", "teach what is mounted, or mount the process's tool"},
      Row{Refused::FilesChanged, "files_changed",
          "mend the line in the page or by biteline line edit, choose the process again, or scan again"},
      Row{Refused::ArmMoved, "arm_moved", k_again},
      Row{Refused::NotRemote, "not_remote", "switch the pendant to remote control"},
      Row{Refused::OtherArm, "other_arm", "check --robot and the controller's address"},
      Row{Refused::OtherSerial, "other_serial", "check --serial and the controller's address"},
      Row{Refused::OtherTool, "other_tool", "plan again with the process that is mounted"},
      Row{Refused::OtherPayload, "other_payload", "plan again with the process that is mounted"},
      Row{Refused::ArmNotHeld, "arm_not_held", "end the other service"},
  };
  return k_rows;
}

}  // namespace biteline::robot
