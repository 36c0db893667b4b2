// SPDX-License-Identifier: MIT
#pragma once
/// \file A shoe's own number, as a barcode or the factory's orders say it: one meaning for every door.

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace biteline::line_control {

inline constexpr std::size_t k_most_part_bytes = 64;
/// Modbus: two letters in a register, the first in its high byte; zeros fill the rest.
inline constexpr std::size_t k_part_registers = k_most_part_bytes / 2;

/// Without blanks at its ends, which scanners and controls add; empty: no part number.  Nothing: no printable
/// text in one line, or a longer one.
[[nodiscard]] std::optional<std::string> part_number(std::string_view text);

/// A longer text is cut.
[[nodiscard]] std::array<std::uint16_t, k_part_registers> registers_of(std::string_view part);
/// The letters before the first zero; nothing: letters stand behind it, or bytes that are no ASCII text.
[[nodiscard]] std::optional<std::string> part_of(std::span<const std::uint16_t> registers);

}  // namespace biteline::line_control
