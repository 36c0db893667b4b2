// SPDX-License-Identifier: MIT
#include "host/intake/capture/refused.hpp"

#include <array>

namespace biteline::capture {

std::span<const report::RefusalRow<AcceptRefused>> refusal_table(AcceptRefused) {
  using Row = report::RefusalRow<AcceptRefused>;
  static constexpr std::array k_rows{
      Row{AcceptRefused::BeyondLimit, "beyond_limit", "calibrate the head again, then scan the pieces again"},
  };
  return k_rows;
}

}  // namespace biteline::capture
