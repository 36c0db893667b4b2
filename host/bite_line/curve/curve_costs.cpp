// SPDX-License-Identifier: MIT
#include "host/bite_line/curve/curve_costs.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <tbb/parallel_for.h>

namespace biteline::bite_line {

namespace {

/// -log of the logistic function.
float cost_of(float log_odds) {
  constexpr float k_certain = 20;
  const float odds = std::clamp(log_odds, -k_certain, k_certain);
  return std::min(std::log1p(std::exp(-odds)), k_most_cost_per_mm);
}

/// Per cell without surface: 1 where some lies above it and some below it, or none in its whole column.
std::vector<std::uint8_t> gaps_of(const Raster& raster) {
  std::vector<std::uint8_t> gap(raster.size(), 0);
  for (int col = 0; col < raster.cols; ++col) {
    const std::uint8_t* seen = raster.seen.data() + raster.at(0, col);
    const std::uint8_t* end = seen + raster.rows;
    const std::uint8_t* low = std::find(seen, end, 1);
    int high = raster.rows - 1;
    while (high >= 0 && seen[high] == 0) --high;
    const int first = low == end ? 0 : static_cast<int>(low - seen);
    const int last = low == end ? raster.rows - 1 : high;
    for (int row = first; row <= last; ++row) gap[raster.at(row, col)] = 1;
  }
  return gap;
}

/// `use(block, first cell, end)`: of each block of columns of the looks.
template <class Use>
void for_blocks(const Raster& raster, Use&& use) {
  constexpr int k_cols = CreaseLooks::k_block_cols;
  tbb::parallel_for(0, (raster.cols + k_cols - 1) / k_cols, [&](int block) {
    use(block, raster.at(0, block * k_cols), raster.at(0, std::min((block + 1) * k_cols, raster.cols)));
  });
}

}  // namespace

CurveCosts curve_costs(const Raster& raster, CreaseLooks& looks, const CurveWeights& weights) {
  const std::vector<std::uint8_t> gap = gaps_of(raster);
  looks.look_beside(weights);
  CurveCosts costs{.rows = raster.rows, .cols = raster.cols, .per_mm = {}};
  costs.per_mm.resize(raster.size() * k_directions);
  const float plain = cost_of(k_line_log_odds + weights.all[static_cast<std::size_t>(CreaseSign::Always)]);
  for_blocks(raster, [&](int block, std::size_t first, std::size_t end) {
    for (std::size_t cell = first; cell < end; ++cell) {
      const bool unseen = raster.seen[cell] == 0 && gap[cell] != 0;
      std::fill_n(&costs.of(cell, 0), k_directions, unseen ? k_unseen_cost_per_mm : plain);
    }
    for (const CreaseLooks::Turning& at : looks.turning(block))
      costs.of(at.cell, at.direction) = cost_of(k_line_log_odds + looks.odds(at));
  });
  return costs;
}

void compare_costs(CurveCosts& costs, const Raster& raster, const CreaseLooks& looks) {
  for_blocks(raster, [&](int block, std::size_t, std::size_t) {
    for (const CreaseLooks::Turning& at : looks.turning(block)) {
      float& cost = costs.of(at.cell, at.direction);
      if (cost < k_most_cost_per_mm) cost = cost_of(k_line_log_odds + looks.odds(at));
    }
  });
}

}  // namespace biteline::bite_line
