// SPDX-License-Identifier: MIT
#include "host/report/ended_by.hpp"

#include <algorithm>
#include <array>

namespace biteline::report {

std::span<const EndedByRow> ended_by_table() {
  using enum EndedBy;
  static constexpr std::array k_rows{
      EndedByRow{"stopped_by_a_person", Person},
      EndedByRow{"local_control", Person},
      EndedByRow{"not_approved", Person},
      EndedByRow{"shoe_moved", Person},
      EndedByRow{"other_shoe", Person},
      // Of the scan itself.
      EndedByRow{"scan_not_complete", Machine},
      EndedByRow{"scan_set_aside", Machine},
      EndedByRow{"test_pattern", Machine},
      EndedByRow{"camera_state", Machine},
      EndedByRow{"no_poses", Machine},
      EndedByRow{"poses_too_far", Machine},
      EndedByRow{"clock_unsure", Machine},
      EndedByRow{"trigger_mismatch", Machine},
      EndedByRow{"frames_damaged", Machine},
      EndedByRow{"no_time", Machine},
      EndedByRow{"frames_lost", Machine},
      EndedByRow{"no_stripe", Machine},
      EndedByRow{"stripe_along_columns", Machine},
      EndedByRow{"not_as_calibrated", Machine},
      EndedByRow{"rerun_failed", Machine},
      // Of the gate.
      EndedByRow{"scan_not_seen", Machine},
      EndedByRow{"scan_too_old", Machine},
      EndedByRow{"other_connection", Machine},
      EndedByRow{"pictures_not_vouched", Machine},
      EndedByRow{"sent_before", Machine},
      EndedByRow{"messages_lost", Machine},
      EndedByRow{"holes_in_scan", Machine},
      EndedByRow{"tool_not_mounted", Machine},
      EndedByRow{"not_as_taught", Machine},
      EndedByRow{"files_changed", Machine},
      EndedByRow{"arm_moved", Machine},
      EndedByRow{"not_remote", Machine},
      EndedByRow{"other_arm", Machine},
      EndedByRow{"other_serial", Machine},
      EndedByRow{"other_tool", Machine},
      EndedByRow{"other_payload", Machine},
      EndedByRow{"arm_not_held", Machine},
      // Of the arm on its way.
      EndedByRow{"off_path", Machine},
      EndedByRow{"off_direction", Machine},
      EndedByRow{"off_way", Machine},
      EndedByRow{"late", Machine},
      EndedByRow{"stalled", Machine},
      EndedByRow{"not_covered", Machine},
      EndedByRow{"silent", Machine},
      EndedByRow{"unusable_state", Machine},
      EndedByRow{"protective_stop", Machine},
      EndedByRow{"power_off", Machine},
      EndedByRow{"not_started", Machine},
      EndedByRow{"not_ended", Machine},
      EndedByRow{"old_states", Machine},
      EndedByRow{"not_sent", Machine},
      EndedByRow{"tool_on", Machine},
      EndedByRow{"program_error", Machine},
      EndedByRow{"no_contact", Machine},
      EndedByRow{"flange_dead", Machine},
      EndedByRow{"contact_lost", Machine},
      EndedByRow{"force_too_high", Machine},
      EndedByRow{"force_off", Machine},
      EndedByRow{"stop_door_closed", Machine},
      // Warnings and questions, which end nothing.
      EndedByRow{"calibration_drifted", Nobody},
      EndedByRow{"line_off_mended", Nobody},
      EndedByRow{"other_process", Nobody},
      EndedByRow{"part_worked_before", Nobody},
      // Of a look at what was done: the shoe was worked.
      EndedByRow{"work_faulty", Nobody},
      EndedByRow{"still_faulty", Nobody},
      EndedByRow{"work_unsure", Nobody},
      EndedByRow{"work_ran_out", Nobody},
      EndedByRow{"no_change_to_tell", Nobody},
      EndedByRow{"work_not_looked_at", Nobody},
      EndedByRow{"sequence_cut", Nobody},
  };
  return k_rows;
}

EndedBy ended_by(std::string_view reason_code) {
  if (reason_code.empty()) return EndedBy::Nobody;
  const auto table = ended_by_table();
  const auto found = std::ranges::find(table, reason_code, &EndedByRow::reason_code);
  return found == table.end() ? EndedBy::Shoe : found->who;
}

const char* name_of(EndedBy who) {
  static constexpr std::array k_names{"", "person", "machine", "shoe"};
  return k_names.at(static_cast<std::size_t>(who));
}

}  // namespace biteline::report
