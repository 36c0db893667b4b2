// SPDX-License-Identifier: MIT
#include "host/second_look/refused.hpp"

#include <array>

namespace biteline::second_look {

std::span<const report::RefusalRow<Refused>> refusal_table(Refused) {
  using enum Refused;
  using Row = report::RefusalRow<Refused>;
  static constexpr std::array k_rows{
      Row{ShoeMoved, "shoe_moved", "look at the shoe by eye, or clamp it and begin anew"},
      Row{OtherShoe, "other_shoe", "give the two scans of one and the same shoe"},
      Row{NotSeen, "too_little_seen", "scan the shoe again, all the way round"},
      Row{NothingToTell, "no_change_to_tell",
          "look by eye whether anything was done; a film that the light does not show cannot be judged"},
  };
  return k_rows;
}

std::span<const report::RefusalRow<Settle>> refusal_table(Settle) {
  using enum Settle;
  using Row = report::RefusalRow<Settle>;
  static constexpr std::array k_rows{
      Row{WorkFaulty, "work_faulty", "look at the places that the report lists, and work them again"},
      Row{StillFaulty, "still_faulty",
          "a person decides: look at the places that the report lists, finish them by hand or name who has "
          "them "
          "worked again"},
      Row{WorkUnsure, "work_unsure", "look by eye at the stretches that the report lists"},
      Row{WorkRanOut, "work_ran_out",
          "fill or clean the gun, or look at the tool; try it beside the shoe, then finish the shoe by hand "
          "or "
          "have it worked again"},
  };
  return k_rows;
}

std::span<const report::RefusalRow<NoRework>> refusal_table(NoRework) {
  using enum NoRework;
  using Row = report::RefusalRow<NoRework>;
  static constexpr std::array k_rows{
      Row{NothingMissing, "nothing_to_rework", "nothing, or look by eye where the look could not tell"},
      Row{ForAPerson, "for_a_person",
          "look at the places that the report lists; narrow ones may be worked twice where a person says so"},
      Row{ReworkedBefore, "reworked_before",
          "a person decides: look at what is still missing, and name who has it worked again"},
  };
  return k_rows;
}

}  // namespace biteline::second_look
