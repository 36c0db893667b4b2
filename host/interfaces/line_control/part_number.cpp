// SPDX-License-Identifier: MIT
#include "host/interfaces/line_control/part_number.hpp"

#include <algorithm>

#include "common/core/text_bounds.hpp"

namespace biteline::line_control {

std::optional<std::string> part_number(std::string_view text) {
  const std::size_t first = text.find_first_not_of(' ');
  if (first == std::string_view::npos) return std::string{};
  text = text.substr(first, text.find_last_not_of(' ') - first + 1);
  if (!bounds::fits(text, k_most_part_bytes)) return std::nullopt;
  return std::string{text};
}

std::array<std::uint16_t, k_part_registers> registers_of(std::string_view part) {
  std::array<std::uint16_t, k_part_registers> registers{};
  for (std::size_t i = 0; i < std::min(part.size(), k_most_part_bytes); ++i) {
    const auto letter = static_cast<std::uint8_t>(part[i]);
    registers.at(i / 2) |= static_cast<std::uint16_t>(i % 2 == 0 ? letter << 8 : letter);
  }
  return registers;
}

std::optional<std::string> part_of(std::span<const std::uint16_t> registers) {
  std::string letters;
  for (const std::uint16_t pair : registers) {
    letters += static_cast<char>(pair >> 8);
    letters += static_cast<char>(pair & 0xFF);
  }
  letters.erase(letters.find_last_not_of('\0') + 1);
  const auto printable = [](char letter) { return letter >= ' ' && letter <= '~'; };
  if (!std::ranges::all_of(letters, printable)) return std::nullopt;
  return letters;
}

}  // namespace biteline::line_control
