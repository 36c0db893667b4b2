// SPDX-License-Identifier: MIT
#include "common/core/text_bounds.hpp"

#include "common/core/text.hpp"

namespace biteline::bounds {

bool fits(std::string_view text, std::size_t most_bytes) {
  return text.size() <= most_bytes && clean_text(text) == text;
}

std::string expected(std::size_t most_bytes) {
  return "a printable text of at most " + std::to_string(most_bytes) + " bytes in one line expected";
}

std::string fitted(std::string_view text, std::size_t most_bytes) {
  constexpr std::string_view k_cut = "...";
  if (text.size() <= most_bytes) return clean_text(text);
  return clean_text(text, most_bytes - k_cut.size()) + std::string{k_cut};
}

}  // namespace biteline::bounds
