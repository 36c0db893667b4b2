// SPDX-License-Identifier: MIT
#pragma once
/// \file Units of length, as options and files name them.

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace biteline::cloud {

enum class Unit : std::uint8_t { Millimetre, Metre, Centimetre, Micrometre, Inch };

struct UnitRow {
  Unit unit;
  const char* name;  ///< as in --unit
  const char* word;  ///< "metres"
  double mm;
};
[[nodiscard]] std::span<const UnitRow> unit_rows();
[[nodiscard]] const UnitRow& unit_row(Unit unit);
[[nodiscard]] double mm_per(Unit unit);

/// "mm", "Millimeter", "µm", "inches" and the like, in any case.
[[nodiscard]] std::optional<Unit> unit_of_word(std::string_view word);

}  // namespace biteline::cloud
