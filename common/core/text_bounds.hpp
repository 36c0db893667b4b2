// SPDX-License-Identifier: MIT
#pragma once
/// \file How long a text may be that people, files and programs give: one table for every door, so that what
/// one takes no other refuses.

#include <cstddef>
#include <string>
#include <string_view>

namespace biteline::bounds {

/// Bytes of UTF-8.
inline constexpr std::size_t k_name = 64;    ///< of a file, a model, a person, a cell: what others call it by
inline constexpr std::size_t k_title = 200;  ///< in words, in one line: a process's own name
inline constexpr std::size_t k_why = 500;    ///< a person's reason for what was done
inline constexpr std::size_t k_reason = 2000;  ///< a program's: why something was refused
inline constexpr std::size_t k_choice = 20;    ///< out of a program's own short list: a verdict
inline constexpr std::size_t k_word = 100;     ///< out of a program's own list: a reason's code
inline constexpr std::size_t k_size = 20;      ///< of a shoe, as its factory writes it: "EU 42"
inline constexpr std::size_t k_value = 1024;   ///< of a settings file, whatever its meaning

/// No longer than that, valid UTF-8, in one line, without control characters or marks of direction.
[[nodiscard]] bool fits(std::string_view text, std::size_t most_bytes);
/// For a fault: "a printable text of at most 64 bytes in one line expected".
[[nodiscard]] std::string expected(std::size_t most_bytes);
/// What does not fit is made so: cleaned, and cut with "..." at its end.
[[nodiscard]] std::string fitted(std::string_view text, std::size_t most_bytes);

}  // namespace biteline::bounds
