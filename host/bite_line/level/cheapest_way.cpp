// SPDX-License-Identifier: MIT
#include "host/bite_line/level/cheapest_way.hpp"

#include <algorithm>
#include <functional>
#include <limits>
#include <queue>
#include <utility>

#include "common/core/contracts.hpp"

namespace biteline::bite_line {

Way cheapest_way(const Patch& patch, const StepCosts& costs, Cell from, Cell to,
                 std::span<const std::uint8_t> barred) {
  BITELINE_EXPECTS(barred.empty() || barred.size() == patch.size());
  constexpr float k_far = std::numeric_limits<float>::max();
  constexpr std::int8_t k_first = -1;
  constexpr float k_barred_cost = 10;
  std::vector<float> total(patch.size(), k_far);
  std::vector<std::int8_t> step(patch.size(), k_first);
  using Open = std::pair<float, std::uint32_t>;
  std::priority_queue<Open, std::vector<Open>, std::greater<>> open;
  const auto end = static_cast<std::uint32_t>(patch.at(to.row, to.col));
  total[patch.at(from.row, from.col)] = 0;
  open.emplace(0.0F, static_cast<std::uint32_t>(patch.at(from.row, from.col)));
  while (!open.empty() && open.top().second != end) {
    const auto [cost, here] = open.top();
    open.pop();
    if (cost > total[here]) continue;
    const int col = static_cast<int>(here) / patch.rows;
    const int row = static_cast<int>(here) % patch.rows;
    for (std::size_t k = 0; k < k_grid_steps.size(); ++k) {
      const int r = row + k_grid_steps[k].rows;
      const int c = col + k_grid_steps[k].cols;
      if (r < 0 || r >= patch.rows || c < 0 || c >= patch.cols) continue;
      const std::size_t there = patch.at(r, c);
      const float bar = !barred.empty() && barred[there] != 0 ? k_barred_cost : 0.0F;
      const float sum =
          cost + Patch::length_mm(k_grid_steps[k]) * (0.5F * (costs[k][here] + costs[k][there]) + bar);
      if (sum >= total[there]) continue;
      total[there] = sum;
      step[there] = static_cast<std::int8_t>(k);
      open.emplace(sum, static_cast<std::uint32_t>(there));
    }
  }
  Way way{.cells = {to}, .cost = static_cast<double>(total[end])};
  for (Cell at = to; step[patch.at(at.row, at.col)] != k_first;) {
    const GridStep by = k_grid_steps[static_cast<std::size_t>(step[patch.at(at.row, at.col)])];
    at = {at.row - by.rows, at.col - by.cols};
    way.cells.push_back(at);
  }
  std::ranges::reverse(way.cells);
  return way;
}

}  // namespace biteline::bite_line
