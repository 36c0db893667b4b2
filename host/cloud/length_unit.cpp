// SPDX-License-Identifier: MIT
#include "host/cloud/length_unit.hpp"

#include <algorithm>
#include <array>
#include <string>

#include "host/cloud/letters.hpp"

namespace biteline::cloud {
namespace {

constexpr std::array k_rows{
    UnitRow{Unit::Millimetre, "mm", "millimetres", 1}, UnitRow{Unit::Metre, "m", "metres", 1000},
    UnitRow{Unit::Centimetre, "cm", "centimetres", 10}, UnitRow{Unit::Micrometre, "um", "micrometres", 0.001},
    UnitRow{Unit::Inch, "in", "inches", 25.4}};

struct Spelling {
  std::string_view word;
  Unit unit;
};
constexpr std::array k_spellings{Spelling{"mm", Unit::Millimetre},
                                 Spelling{"millimetre", Unit::Millimetre},
                                 Spelling{"millimeter", Unit::Millimetre},
                                 Spelling{"m", Unit::Metre},
                                 Spelling{"metre", Unit::Metre},
                                 Spelling{"meter", Unit::Metre},
                                 Spelling{"cm", Unit::Centimetre},
                                 Spelling{"centimetre", Unit::Centimetre},
                                 Spelling{"centimeter", Unit::Centimetre},
                                 Spelling{"um", Unit::Micrometre},
                                 Spelling{"\xC2\xB5m", Unit::Micrometre},
                                 Spelling{"\xCE\xBCm", Unit::Micrometre},
                                 Spelling{"\xB5m", Unit::Micrometre},
                                 Spelling{"micron", Unit::Micrometre},
                                 Spelling{"micrometre", Unit::Micrometre},
                                 Spelling{"micrometer", Unit::Micrometre},
                                 Spelling{"in", Unit::Inch},
                                 Spelling{"inch", Unit::Inch},
                                 Spelling{"inche", Unit::Inch}};

}  // namespace

std::span<const UnitRow> unit_rows() {
  return k_rows;
}

const UnitRow& unit_row(Unit unit) {
  return *std::ranges::find(k_rows, unit, &UnitRow::unit);
}

double mm_per(Unit unit) {
  return unit_row(unit).mm;
}

std::optional<Unit> unit_of_word(std::string_view word) {
  std::string plain = small_letters(word);
  if (plain.size() > 3 && plain.ends_with('s')) plain.pop_back();
  const auto found = std::ranges::find(k_spellings, std::string_view{plain}, &Spelling::word);
  return found == k_spellings.end() ? std::nullopt : std::optional{found->unit};
}

}  // namespace biteline::cloud
