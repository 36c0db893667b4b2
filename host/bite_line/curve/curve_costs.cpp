// SPDX-License-Identifier: MIT
#include "host/bite_line/curve/curve_costs.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <tbb/blocked_range.h>
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

}  // namespace

CurveCosts curve_costs(const Raster& raster, CreaseLooks& looks, const CurveWeights& weights) {
  const std::vector<std::uint8_t> gap = gaps_of(raster);
  looks.look_beside(weights);
  CurveCosts costs{.rows = raster.rows, .cols = raster.cols, .per_mm = {}};
  costs.per_mm.resize(raster.size() * k_directions);
  const float plain = cost_of(k_line_log_odds + weights.all[static_cast<std::size_t>(CreaseSign::Always)]);
  tbb::parallel_for(tbb::blocked_range<int>{0, raster.cols, 16}, [&](const auto& range) {
    for (int col = range.begin(); col != range.end(); ++col) {
      for (int row = 0; row < raster.rows; ++row) {
        const std::size_t cell = raster.at(row, col);
        for (std::size_t k = 0; k < k_directions; ++k) {
          float& cost = costs.of(cell, k);
          if (raster.seen[cell] == 0)
            cost = gap[cell] != 0 ? k_unseen_cost_per_mm : plain;
          else
            cost = looks.turns(cell, k) ? cost_of(k_line_log_odds + looks.odds(cell, k)) : plain;
        }
      }
    }
  });
  return costs;
}

void compare_costs(CurveCosts& costs, const Raster& raster, const CreaseLooks& looks,
                   const SignWeights& usual) {
  const float plain = cost_of(k_line_log_odds + usual[static_cast<std::size_t>(CreaseSign::Always)]);
  tbb::parallel_for(tbb::blocked_range<int>{0, raster.cols, 16}, [&](const auto& range) {
    for (int col = range.begin(); col != range.end(); ++col) {
      for (int row = 0; row < raster.rows; ++row) {
        const std::size_t cell = raster.at(row, col);
        if (raster.seen[cell] == 0) continue;
        for (std::size_t k = 0; k < k_directions; ++k) {
          float& cost = costs.of(cell, k);
          if (cost < k_most_cost_per_mm)
            cost = looks.turns(cell, k) ? cost_of(k_line_log_odds + looks.odds(cell, k)) : plain;
        }
      }
    }
  });
}

}  // namespace biteline::bite_line
