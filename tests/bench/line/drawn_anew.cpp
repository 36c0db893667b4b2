// SPDX-License-Identifier: MIT
#include "tests/bench/line/drawn_anew.hpp"

#include <algorithm>
#include <cstddef>
#include <random>

namespace biteline::bench {

std::array<double, 2> drawn_anew(const std::vector<ShoeShare>& shoes) {
  constexpr int k_draws = 1000;
  if (shoes.empty()) return {0, 0};
  std::mt19937 random{1};
  std::uniform_int_distribution<std::size_t> any{0, shoes.size() - 1};
  std::vector<double> shares;
  for (int draw = 0; draw < k_draws; ++draw) {
    ShoeShare sum;
    for (std::size_t k = 0; k < shoes.size(); ++k) {
      const ShoeShare& one = shoes[any(random)];
      sum.part += one.part;
      sum.whole += one.whole;
    }
    if (sum.whole > 0) shares.push_back(sum.part / sum.whole);
  }
  if (shares.empty()) return {0, 0};
  std::sort(shares.begin(), shares.end());
  const auto at = [&](double share) {
    return shares[static_cast<std::size_t>(share * static_cast<double>(shares.size() - 1))];
  };
  return {at(0.025), at(0.975)};
}

}  // namespace biteline::bench
