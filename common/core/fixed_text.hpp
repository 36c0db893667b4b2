// SPDX-License-Identifier: MIT
#pragma once
/// \file Text of bounded length that lives inside its owner: no heap, trivially copyable.

#include <array>
#include <cstdarg>
#include <cstddef>
#include <cstdio>
#include <string_view>

namespace biteline {

/// At most `Capacity` - 1 characters; what does not fit is cut at the end.
template <std::size_t Capacity>
class FixedText {
 public:
  constexpr FixedText() = default;

  /// printf-style; the format must match its arguments (checked by the compiler).
  [[gnu::format(printf, 1, 2)]] static FixedText format(const char* pattern, ...) {
    FixedText text;
    std::va_list arguments;
    va_start(arguments, pattern);
    std::vsnprintf(text.characters_.data(), Capacity, pattern, arguments);
    va_end(arguments);
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
