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
      Row{WorkUnsure, "work_unsure", "look by eye at the stretches that the report lists"},
  };
  return k_rows;
}

}  // namespace biteline::second_look
