// SPDX-License-Identifier: MIT
#include "tests/soak/light_book.hpp"

#include <utility>

namespace biteline::soak {

std::uint64_t LightBook::unasked(std::uint64_t lit, std::uint64_t asked) {
  const std::uint64_t lightings = lit - std::exchange(lit_, lit);
  const std::uint64_t askings = asked - std::exchange(asked_, asked);
  const std::uint64_t have = askings + (open_ ? 1 : 0);
  open_ = have > lightings;
  return lightings > have ? lightings - have : 0;
}

}  // namespace biteline::soak
