// SPDX-License-Identifier: MIT
#pragma once
/// \file Numbers in sentences, as people read them.

#include <algorithm>
#include <cmath>
#include <string>

#include "common/core/fixed_text.hpp"

namespace biteline {

/// With three digits that count, whole from 100 on, and a space after each three from 10 000 on: 0.28, 11.6,
/// 1235, 280 000.  A power of ten is told only of what is beyond 1e15 or below 1e-6.
[[nodiscard]] inline std::string plain_number(double value) {
  constexpr double k_largest = 1e15, k_smallest = 1e-6, k_grouped = 1e4;
  const double size = std::abs(value);
  if (!(size < k_largest) || (size > 0 && size < k_smallest))
    return std::string{FixedText<32>::format("%.3g", value).view()};
  const int decimals = size > 0 ? std::clamp(2 - static_cast<int>(std::floor(std::log10(size))), 0, 8) : 0;
  std::string text{FixedText<40>::format("%.*f", decimals, value).view()};
  if (text.find('.') != std::string::npos) {
    text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.') text.pop_back();
  }
  if (size < k_grouped) return text;
  std::string grouped;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (i > (value < 0 ? 1U : 0U) && (text.size() - i) % 3 == 0) grouped += ' ';
    grouped += text[i];
  }
  return grouped;
}

}  // namespace biteline
