// SPDX-License-Identifier: MIT
// Each reason of each module is a person's, the machine's or the shoe's.
#include "host/report/ended_by.hpp"

#include <CppUTest/TestHarness.h>

#include <set>
#include <string>

#include "host/apps/biteline-host/refused.hpp"
#include "host/bite_line/refused.hpp"
#include "host/calibration/consistency/refused.hpp"
#include "host/intake/refused.hpp"
#include "host/records/memory/history.hpp"
#include "host/robot/link/gate/refused.hpp"
#include "host/robot/link/halt.hpp"
#include "host/robot/path/refused.hpp"
#include "host/second_look/refused.hpp"
#include "host/transfer/refused.hpp"

namespace biteline {

using report::ended_by;
using report::EndedBy;

TEST_GROUP(EndedBy) {
  std::set<std::string> declared;

  /// All codes of a module, `who` but those that are told.
  template <class Code>
  void all(Code code, EndedBy who, const std::set<std::string>& others = {}) {
    for (const report::RefusalRow<Code>& row : refusal_table(code)) {
      declared.insert(row.name);
      if (!others.contains(row.name)) CHECK_TEXT(ended_by(row.name) == who, row.name);
    }
    for (const std::string& other : others) {
      CHECK_TEXT(declared.contains(other), other.c_str());
      CHECK_TEXT(ended_by(other) != who, other.c_str());
    }
  }
};

TEST(EndedBy, EachReasonOfEachModuleIsSomebodys) {
  all(intake::Refused::NoPoses, EndedBy::Machine, {"stopped_by_a_person"});
  all(consistency::Refused{}, EndedBy::Machine);
  all(robot::Halt::OffPath, EndedBy::Machine, {"stopped_by_a_person", "local_control"});
  all(robot::Refused::ScanTooOld, EndedBy::Machine,
      {"stopped_by_a_person", "not_approved", "shoe_moved", "other_shoe", "line_not_passed",
       "path_not_passed", "too_uncertain", "tip_too_far"});
  all(bite_line::Refused{}, EndedBy::Shoe);
  all(transfer::Refused{}, EndedBy::Shoe);
  all(path::Refused{}, EndedBy::Shoe, {"not_as_taught"});
  all(service::Refused::ModelUnknown, EndedBy::Shoe,
      {"rerun_failed", "calibration_drifted", "other_process", "line_off_mended", "part_worked_before",
       "work_not_looked_at", "sequence_cut"});
  all(second_look::Refused{}, EndedBy::Shoe, {"shoe_moved", "other_shoe", "no_change_to_tell"});
  all(second_look::Settle{}, EndedBy::Nobody);
  for (const char* code : {"no_change_to_tell", "work_not_looked_at", "sequence_cut"})
    CHECK_TEXT(ended_by(code) == EndedBy::Nobody, code);
  for (const char* code : {"line_not_passed", "path_not_passed", "too_uncertain", "tip_too_far"})
    CHECK_TEXT(ended_by(code) == EndedBy::Shoe, code);
  for (const char* code :
       {"stopped_by_a_person", "local_control", "not_approved", "shoe_moved", "other_shoe"})
    CHECK_TEXT(ended_by(code) == EndedBy::Person, code);
  // A name that nobody says any more would hide that its reason has another one by now.
  std::set<std::string> listed;
  for (const report::EndedByRow& row : report::ended_by_table()) {
    const std::string code{row.reason_code};
    CHECK_TEXT(declared.contains(code), code.c_str());
    CHECK_TEXT(listed.insert(code).second, code.c_str());
  }
}

TEST(EndedBy, ARowSaysSoByDecisionVerdictAndReason) {
  const auto who = [](const char* verdict, const char* reason_code, const char* decision = "open") {
    memory::Scan row;
    row.verdict = verdict;
    row.reason_code = reason_code;
    row.decision = decision;
    return memory::ended_by(row);
  };
  CHECK(who("refused", "stopped_by_a_person") == EndedBy::Person);
  CHECK(who("refused", "no_poses") == EndedBy::Machine);
  CHECK(who("refused", "not_a_shoe") == EndedBy::Shoe);
  CHECK(who("refused", "") == EndedBy::Shoe);
  CHECK(who("failed", "") == EndedBy::Machine);
  CHECK(who("ok", "") == EndedBy::Nobody);
  CHECK(who("ok", "", "accepted") == EndedBy::Nobody);
  CHECK(who("ok", "", "rejected") == EndedBy::Person);
  CHECK(who("ok", "holes_in_scan") == EndedBy::Machine);
  CHECK(who("ok", "too_uncertain") == EndedBy::Shoe);
  CHECK(who("ok", "stopped_by_a_person") == EndedBy::Person);
  CHECK(who("amber", "calibration_drifted", "automatic") == EndedBy::Nobody);
  // It waits: nobody has ended it yet.
  CHECK(who("ok", "model_unknown", "held") == EndedBy::Nobody);
  CHECK(who("review", "still_unsure") == EndedBy::Nobody);
  CHECK(who("working", "") == EndedBy::Nobody);
}

}  // namespace biteline
