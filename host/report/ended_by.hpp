// SPDX-License-Identifier: MIT
#pragma once
/// \file Who ended a scan: a person, the machine or the shoe.  Only the last says anything of a shoe.

#include <span>
#include <string_view>

namespace biteline::report {

enum class EndedBy {
  Nobody,   ///< it came to its end, warned of or not
  Person,   ///< somebody stopped it, took the arm, took or moved the shoe, or said no
  Machine,  ///< sensor, arm, network, disk or this machine: another scan of the same shoe may be good
  Shoe,     ///< what was seen of it gives no line, or no path along it
};

/// By the `reason_code` of a report, a gate or a run; empty: Nobody.
[[nodiscard]] EndedBy ended_by(std::string_view reason_code);
/// "person", "machine" or "shoe"; empty for Nobody.
[[nodiscard]] const char* name_of(EndedBy who);

struct EndedByRow {
  std::string_view reason_code;
  EndedBy who;
};
/// Those that are not the shoe's.
[[nodiscard]] std::span<const EndedByRow> ended_by_table();

}  // namespace biteline::report
