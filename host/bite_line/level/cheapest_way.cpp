// SPDX-License-Identifier: MIT
#include "host/bite_line/level/cheapest_way.hpp"

#include <algorithm>
#include <functional>
#include <limits>
#include <queue>
#include <utility>

#include "common/core/contracts.hpp"

namespace biteline::bite_line {

namespace {

float step_cost(const std::vector<float>& of_step, std::size_t k, std::size_t here, std::size_t there) {
  return Patch::length_mm(k_grid_steps[k]) * 0.5F * (of_step[here] + of_step[there]);
}

}  // namespace

WayTree cheapest_ways(const Patch& patch, const StepCosts& costs, Cell root, Towards towards,
                      std::optional<Cell> only, std::span<const std::uint8_t> barred) {
  BITELINE_EXPECTS(barred.empty() || barred.size() == patch.size());
  constexpr float k_barred_cost = 10;
  const int sign = towards == Towards::Others ? 1 : -1;
  WayTree tree{.total = std::vector<float>(patch.size(), std::numeric_limits<float>::max()),
               .step = std::vector<std::int8_t>(patch.size(), WayTree::k_root)};
  using Open = std::pair<float, std::uint32_t>;
  std::priority_queue<Open, std::vector<Open>, std::greater<>> open;
  const std::size_t end = only ? patch.at(only->row, only->col) : patch.size();
  tree.total[patch.at(root.row, root.col)] = 0;
  open.emplace(0.0F, static_cast<std::uint32_t>(patch.at(root.row, root.col)));
  while (!open.empty() && open.top().second != end) {
    const auto [cost, here] = open.top();
    open.pop();
    if (cost > tree.total[here]) continue;
    const int col = static_cast<int>(here) / patch.rows;
    const int row = static_cast<int>(here) % patch.rows;
    for (std::size_t k = 0; k < k_grid_steps.size(); ++k) {
      const int r = row + sign * k_grid_steps[k].rows;
      const int c = col + sign * k_grid_steps[k].cols;
      if (r < 0 || r >= patch.rows || c < 0 || c >= patch.cols) continue;
      const std::size_t there = patch.at(r, c);
      const float bar = !barred.empty() && barred[there] != 0 ? k_barred_cost : 0.0F;
      const float sum = cost + step_cost(costs[k], k, here, there) + Patch::length_mm(k_grid_steps[k]) * bar;
      if (sum >= tree.total[there]) continue;
      tree.total[there] = sum;
      tree.step[there] = static_cast<std::int8_t>(k);
      open.emplace(sum, static_cast<std::uint32_t>(there));
    }
  }
  return tree;
}

std::vector<Vec2> places_of(const Patch& patch, const Way& way) {
  std::vector<Vec2> places;
  for (const Cell& at : way.cells) places.push_back(patch.place(at.row, at.col));
  return places;
}

double cost_of(const Patch& patch, const StepCosts& costs, std::span<const Cell> cells) {
  double sum = 0;
  for (std::size_t i = 1; i < cells.size(); ++i) {
    const std::size_t k = step_between(cells[i - 1], cells[i]);
    const std::size_t here = patch.at(cells[i - 1].row, cells[i - 1].col);
    const std::size_t there = patch.at(cells[i].row, cells[i].col);
    sum += static_cast<double>(step_cost(costs[k], k, here, there));
  }
  return sum;
}

std::vector<Cell> cells_to_root(const Patch& patch, const WayTree& tree, Towards towards, Cell from) {
  const int sign = towards == Towards::Others ? -1 : 1;
  std::vector<Cell> cells{from};
  for (std::int8_t step = tree.step[patch.at(from.row, from.col)]; step != WayTree::k_root;
       step = tree.step[patch.at(cells.back().row, cells.back().col)]) {
    const GridStep by = k_grid_steps[static_cast<std::size_t>(step)];
    cells.push_back({cells.back().row + sign * by.rows, cells.back().col + sign * by.cols});
  }
  return cells;
}

Way cheapest_way(const Patch& patch, const StepCosts& costs, Cell from, Cell to,
                 std::span<const std::uint8_t> barred) {
  const WayTree tree = cheapest_ways(patch, costs, from, Towards::Others, to, barred);
  Way way{.cells = cells_to_root(patch, tree, Towards::Others, to),
          .cost = static_cast<double>(tree.total[patch.at(to.row, to.col)])};
  std::ranges::reverse(way.cells);
  return way;
}

}  // namespace biteline::bite_line
