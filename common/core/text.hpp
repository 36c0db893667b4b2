// SPDX-License-Identifier: MIT
#pragma once
/// \file Text from outside: the one place that makes it fit for a terminal, a page and JSON.

#include <cstddef>
#include <string>
#include <string_view>

namespace biteline {

/// Replaces with '?', in place: control characters (of ASCII and of Latin-1), line and paragraph separators,
/// marks that turn the direction of reading, and every byte that is no part of valid UTF-8.  Returns the new
/// length, never above `size`.
std::size_t clean_text_in_place(char* text, std::size_t size);

/// The same as a copy of at most `max_bytes`, cut between letters.
[[nodiscard]] std::string clean_text(std::string_view text, std::size_t max_bytes = std::string_view::npos);

/// The longest beginning of at most `max_bytes` that does not end inside a UTF-8 letter.
[[nodiscard]] std::string_view cut_text(std::string_view text, std::size_t max_bytes);

/// Writes at most `capacity` - 1 bytes of a text that is longer, and a zero: its beginning, "...", its end,
/// cut between letters.  The end has more room: the file's name and the reason stand there.  Pre: capacity
/// above 6.
void shorten_text(char* out, std::size_t capacity, std::string_view text);

}  // namespace biteline
