// SPDX-License-Identifier: MIT
#include "host/records/recording/refused.hpp"

#include <array>

namespace biteline::recording {

std::span<const report::RefusalRow<Refused>> refusal_table(Refused) {
  using enum Refused;
  using Row = report::RefusalRow<Refused>;
  static constexpr std::array k_rows{
      Row{Damaged, "recording_damaged",
          "copy it again; biteline record import takes what is before the damage"},
      Row{OtherLink, "recording_changed", "compare with the file whose last link was kept"},
  };
  return k_rows;
}

}  // namespace biteline::recording
