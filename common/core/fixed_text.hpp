// SPDX-License-Identifier: MIT
#pragma once
/// \file Text of bounded length that lives inside its owner: no heap, trivially copyable.

#include <algorithm>
#include <array>
#include <cstdarg>
#include <cstddef>
#include <cstdio>
#include <string_view>

#include "common/core/text.hpp"

namespace biteline {

/// At most `Capacity` - 1 bytes.  A longer text has "..." where its middle was (shorten_text()).
template <std::size_t Capacity>
class FixedText {
 public:
  constexpr FixedText() = default;

  /// printf-style; the format must match its arguments (checked by the compiler).
  [[gnu::format(printf, 1, 2)]] static FixedText format(const char* pattern, ...) {
    FixedText text;
    std::va_list arguments;
    va_start(arguments, pattern);
    const int wanted = std::vsnprintf(text.characters_.data(), Capacity, pattern, arguments);
    va_end(arguments);
    if (wanted < static_cast<int>(Capacity)) return text;
    // Longer than any path and its reason: what lies beyond is not even looked at.
    std::array<char, 4 * 1024> whole;
    va_start(arguments, pattern);
    std::vsnprintf(whole.data(), whole.size(), pattern, arguments);
    va_end(arguments);
    shorten_text(text.characters_.data(), Capacity,
                 {whole.data(), std::min(static_cast<std::size_t>(wanted), whole.size() - 1)});
    return text;
  }

  static FixedText copy(std::string_view source) {
    return format("%.*s", static_cast<int>(source.size()), source.data());
  }

  [[nodiscard]] const char* c_str() const { return characters_.data(); }
  [[nodiscard]] std::string_view view() const { return {characters_.data()}; }
  [[nodiscard]] bool empty() const { return characters_[0] == '\0'; }

 private:
  std::array<char, Capacity> characters_{};
};

}  // namespace biteline
