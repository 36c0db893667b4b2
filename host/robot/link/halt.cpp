// SPDX-License-Identifier: MIT
#include "host/robot/link/halt.hpp"

#include <array>

namespace biteline::robot {

std::span<const report::RefusalRow<Halt>> refusal_table(Halt) {
  using Row = report::RefusalRow<Halt>;
  static constexpr std::array k_rows{
      Row{Halt::OffPath, "off_path", "look at tool and shoe, and scan again before the arm moves on"},
      Row{Halt::OffDirection, "off_direction",
          "look at tool and shoe, and scan again before the arm moves on"},
      Row{Halt::OffWay, "off_way", "clear the arm's way, and scan again"},
      Row{Halt::OtherTool, "other_tool", "end whatever else sets the tool on the controller"},
      Row{Halt::Late, "late", "set the speed slider, and scan again"},
      Row{Halt::Stalled, "stalled", "see on the pendant what holds the program, and scan again"},
      Row{Halt::NotCovered, "not_covered", "work the shoe again, or put it aside"},
      Row{Halt::Silent, "silent", "check the network and the controller"},
      Row{Halt::Unusable, "unusable_state", "check the controller: it sends states without numbers"},
      Row{Halt::ProtectiveStop, "protective_stop", "clear the cause on the pendant, and scan again"},
      Row{Halt::PowerOff, "power_off", "power the arm up on the pendant, and scan again"},
      Row{Halt::LocalControl, "local_control",
          "ask who stands at the pendant; set it to remote control, and scan again"},
      Row{Halt::NotStarted, "not_started", "see on the pendant why the program does not start"},
      Row{Halt::NotEnded, "not_ended", "see on the pendant what holds the program"},
      Row{Halt::Person, "stopped_by_a_person", "scan again when the cell is ready"},
      Row{Halt::Old, "old_states",
          "see what holds up the controller's states: network, relay, a busy machine"},
      Row{Halt::NotSent, "not_sent", "check the network to the controller, and scan again"},
      Row{Halt::ToolOn, "tool_on", "switch the tool off at its supply, then see what holds its output on"},
      Row{Halt::ProgramError, "program_error",
          "read the controller's log; a newer controller or another process may be needed"},
      Row{Halt::NoContact, "no_contact", "look at tool and shoe: worn, moved, or not there; scan again"},
      Row{Halt::ContactLost, "contact_lost", "look at tool and shoe: worn, broken or moved; scan again"},
      Row{Halt::ForceTooHigh, "force_too_high", "look at tool and shoe for damage, and scan again"},
      Row{Halt::ForceOff, "force_off",
          "check the tool and the arm's force sensor: its zero, the payload, cables that pull"},
      Row{Halt::FlangeDead, "flange_dead",
          "look at the flange: its air, its power, its lines, an end of its stroke; scan again"},
      Row{Halt::StopDoorClosed, "stop_door_closed",
          "set the controller to remote control, and see what ends connections to its script port"},
  };
  return k_rows;
}

}  // namespace biteline::robot
