// SPDX-License-Identifier: MIT
#pragma once
/// \file Words of files compared in small letters.

#include <algorithm>
#include <string>
#include <string_view>

namespace biteline::cloud {

/// ASCII alone: no locale has a say in it.
[[nodiscard]] inline std::string small_letters(std::string_view text) {
  std::string small(text);
  std::ranges::transform(small, small.begin(),
                         [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c | 0x20) : c; });
  return small;
}

}  // namespace biteline::cloud
