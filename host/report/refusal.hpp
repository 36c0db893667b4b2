// SPDX-License-Identifier: MIT
#pragma once
/// \file Refusals: readable input without a trustworthy result, by a code that programs can rely on.
///
/// Each module that refuses has an `enum class` of its reasons and one table of them, beside each other:
///
///     enum class Refused { TooLittleOverlap, OtherFoot };
///     [[nodiscard]] std::span<const report::RefusalRow<Refused>> refusal_table(Refused);
///
/// A stage returns a `report::Refusal<Refused>`; at the border `told()` adds the table's words, and
/// report.json has them as `reason_code`, `reason` and `next_step`.  Nothing is decided by searching in the
/// sentence.

#include <span>
#include <string>

#include "common/core/contracts.hpp"

namespace biteline::report {

template <class Code>
struct RefusalRow {
  Code code;
  const char* name;       ///< snake_case, `reason_code` in report.json; never changed once it was released
  const char* next_step;  ///< what the person does next
};

/// Why there is no result.
template <class Code>
struct Refusal {
  Code code;
  std::string reason;  ///< one plain sentence with this case's figures
};

/// A refusal as report.json says it, whichever module it comes from.
struct ToldRefusal {
  std::string reason_code;
  std::string reason;
  std::string next_step;
};

/// The row of `code`.  Pre: the module's table has it (each module's test walks its table).
template <class Code>
[[nodiscard]] const RefusalRow<Code>& refusal_row(Code code) {
  const std::span<const RefusalRow<Code>> table = refusal_table(code);
  for (const RefusalRow<Code>& row : table) {
    if (row.code == code) return row;
  }
  BITELINE_EXPECTS(!"refusal code without a row");
  return table.front();
}

template <class Code>
[[nodiscard]] ToldRefusal told(const Refusal<Code>& refusal) {
  const RefusalRow<Code>& row = refusal_row(refusal.code);
  return {.reason_code = row.name, .reason = refusal.reason, .next_step = row.next_step};
}

}  // namespace biteline::report
