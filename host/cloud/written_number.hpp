// SPDX-License-Identifier: MIT
#pragma once
/// \file Numbers as any program writes them.

#include <charconv>
#include <cmath>
#include <cstdint>
#include <string_view>

namespace biteline::cloud {

enum class Written : std::uint8_t {
  Number,   ///< finite
  Nothing,  ///< an empty cell, or a word: NaN, inf, null, n/a, "-", 1.#QNAN, #DIV/0!, ****
  Wrong,    ///< digits that are no number: 12.5.3, 1'234, x3
};

/// The part of written_number() for what std::from_chars does not take.
[[nodiscard]] Written unusual_number(std::string_view text, char decimal, double& value);

/// `value`: set for a Number only.  Blanks and quotes around it, a plus sign, Fortran's 1.0D+01 and 0.1-101,
/// and `decimal` as decimal sign are taken.  A number too large for a double is Nothing.
[[nodiscard]] inline Written written_number(std::string_view text, char decimal, double& value) {
  if (decimal == '.') {
    double read = 0;
    const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), read);
    if (status == std::errc{} && end == text.data() + text.size()) {
      if (!std::isfinite(read)) return Written::Nothing;
      value = read;
      return Written::Number;
    }
  }
  return unusual_number(text, decimal, value);
}

/// Blanks, tabs and line ends off both sides.
[[nodiscard]] std::string_view trimmed(std::string_view text);

}  // namespace biteline::cloud
