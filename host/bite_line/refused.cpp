// SPDX-License-Identifier: MIT
#include "host/bite_line/refused.hpp"

#include <array>

namespace biteline::bite_line {

std::span<const report::RefusalRow<Refused>> refusal_table(Refused) {
  using enum Refused;
  using Row = report::RefusalRow<Refused>;
  constexpr const char* k_settle =
      "settle the flagged stretches by biteline line edit or in the page, or transfer the line of a sample";
  static constexpr std::array k_rows{
      Row{TooFewPoints, "too_few_points", "put the shoe into the sensor's sight and scan again"},
      Row{NothingConnected, "nothing_connected", "put the shoe into the sensor's sight and scan again"},
      Row{NotShoeSized, "not_shoe_sized", "scan one whole shoe, and nothing that touches it"},
      Row{NoCrease, "no_crease", "push the sole on, or transfer the line of a sample"},
      Row{TooMuchMissing, "too_much_missing", "scan the shoe again, all the way round"},
      Row{NoCreaseAllRound, "no_crease_all_round", "push the sole on, or transfer the line of a sample"},
      Row{WithinOneSurface, "within_one_surface", "push the sole on, or transfer the line of a sample"},
      Row{DoesNotClose, "does_not_close", "scan again; the shoe must stand still meanwhile"},
      Row{NotAShoe, "not_a_shoe", "scan a shoe with its sole on"},
      Row{NoUpper, "no_upper", "scan a shoe with a closed upper"},
      Row{NoSole, "no_sole", "scan a shoe with its sole on, and with the sole in sight"},
      Row{Overhang, "overhang", "scan a shoe with its sole on"},
      Row{CutIntoSole, "cut_into_sole", k_settle},
      Row{Rivalled, "rivalled", k_settle},
      Row{TooMuchUnsure, "too_much_unsure", k_settle},
      Row{TooMuchUncertain, "too_much_uncertain",
          "settle the flagged stretches by biteline line edit or in the page, or scan with less noise and "
          "vibration"},
      Row{TooMuchBridged, "too_much_bridged",
          "scan the shoe again, all the way round, or settle the flagged stretches by biteline line edit or "
          "in the page"},
      Row{NotSure, "not_sure", k_settle},
  };
  return k_rows;
}

}  // namespace biteline::bite_line
