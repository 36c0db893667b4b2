// SPDX-License-Identifier: MIT
#pragma once
/// \file How long tests with made-up bytes go on: BITELINE_FUZZ times as long as usual, from other seeds.

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <random>
#include <vector>

namespace biteline::test {

inline int fuzz_factor() {
  const char* const text = std::getenv("BITELINE_FUZZ");
  return text == nullptr ? 1 : std::max(1, std::atoi(text));
}

/// Changes some bytes, or the length.
inline void garble(std::vector<std::uint8_t>& bytes, std::mt19937_64& random) {
  for (std::uint64_t changes = 1 + random() % 4; changes > 0 && !bytes.empty(); --changes) {
    const std::size_t at = random() % bytes.size();
    switch (random() % 6) {
      case 0:
        bytes.resize(at);
        break;
      case 1:
        bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(at), 1 + random() % 9,
                     static_cast<std::uint8_t>(random()));
        break;
      case 2:
        bytes[at] ^= static_cast<std::uint8_t>(1U << random() % 8);
        break;
      case 3:
        bytes[at] = static_cast<std::uint8_t>(random() % 2 == 0 ? 0x00 : 0xFF);
        break;
      default:
        bytes[at] = static_cast<std::uint8_t>(random());
        break;
    }
  }
}

}  // namespace biteline::test
