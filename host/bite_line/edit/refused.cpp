// SPDX-License-Identifier: MIT
#include "host/bite_line/edit/refused.hpp"

#include <array>

namespace biteline::edit {

std::span<const report::RefusalRow<Refused>> refusal_table(Refused) {
  using enum Refused;
  using Row = report::RefusalRow<Refused>;
  static constexpr std::array k_rows{
      Row{NothingToMend, "nothing_to_mend", "scan the shoe again, all the way round"},
      Row{NoSuchCandidate, "no_such_candidate", "take one of the candidates that the report lists"},
      Row{NoSuchVersion, "no_such_version", "take one of the versions that `biteline line show` lists"},
      Row{NoLine, "no_line", "take a candidate first"},
      Row{BadStretch, "bad_stretch", "choose A and B from 2 mm to half the line's length apart"},
      Row{HintOffSide, "hint_off_side", "choose points on the shoe's side, where the scan shows it"},
      Row{HintOutside, "hint_outside", "choose A and B so that every point lies between them"},
      Row{NoCourse, "no_course", "set A and B farther from the points, or lead through fewer of them"},
      Row{StillUnsure, "still_unsure", "settle the stretches that are still flagged, too"},
      Row{LineCheck, "line_check", "mend the place that the reason names, or go back to an older version"},
      Row{ScanUnusable, "scan_unusable", "scan the shoe again"},
  };
  return k_rows;
}

}  // namespace biteline::edit
