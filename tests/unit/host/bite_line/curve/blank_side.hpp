// SPDX-License-Identifier: MIT
#pragma once
/// \file A blank side, whose places cost what a test says, and the best curve on it.

#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <utility>

#include "host/bite_line/curve/curve_costs.hpp"
#include "host/bite_line/curve/curve_ground.hpp"
#include "host/bite_line/curve/curve_search.hpp"

namespace biteline::bite_line::test {

inline constexpr double k_turn_mm = 150;
inline constexpr int k_rows = 80, k_cols = 200;

/// Cells of which those that `on` says cost `own` for each millimetre in any direction, the others 3.
inline CurveCosts costs_where(const std::function<bool(int row, int col)>& on, float own = 0.05F) {
  CurveCosts costs{.rows = k_rows, .cols = k_cols, .per_mm = {}};
  costs.per_mm.resize(static_cast<std::size_t>(k_rows) * k_cols * k_directions);
  for (int col = 0; col < k_cols; ++col)
    for (int row = 0; row < k_rows; ++row)
      for (std::size_t k = 0; k < k_directions; ++k)
        costs.of(costs.at(row, col), k) = on(row, col) ? own : 3.0F;
  return costs;
}

inline Raster blank_raster() {
  Raster raster;
  raster.rows = k_rows;
  raster.cols = k_cols;
  raster.col_mm = k_turn_mm / k_cols;
  for (PooledVector<float>* values : {&raster.o_mm, &raster.along_ratio, &raster.up_ratio}) {
    values->resize(raster.size());
    std::fill(values->begin(), values->end(), 0.0F);
  }
  raster.seen.resize(raster.size());
  std::fill(raster.seen.begin(), raster.seen.end(), std::uint8_t{1});
  return raster;
}

/// A guard: straight up, along, and straight down again.
inline bool on_gate(int row, int col) {
  constexpr int k_low = 20, k_high = 50, k_from = 80, k_to = 110;
  const auto near = [](int a, int b) { return std::abs(a - b) <= 1; };
  if (col < k_from || col > k_to) return near(row, k_low);
  const bool flank = near(col, k_from + 1) || near(col, k_to - 1);
  return near(row, k_high) || (flank && row >= k_low && row <= k_high);
}

/// A blank side with these costs.
inline std::unique_ptr<CurveGround> ground_of(CurveCosts costs) {
  auto ground = std::make_unique<CurveGround>(blank_raster(), fitted_weights());
  ground->costs = std::move(costs);
  return ground;
}

inline ClosedCurve best_of(const CurveCosts& costs) {
  std::optional<ClosedCurve> best = CurveSearch{costs, {}}.best();
  CHECK(best.has_value());
  return *std::move(best);
}

inline bool leads_over(const ClosedCurve& curve, int row, int col) {
  return std::ranges::any_of(curve.states, [&](const CurveState& at) {
    return std::abs(at.row - row) <= 1 && std::abs((at.col - col) % k_cols) <= 1;
  });
}

}  // namespace biteline::bite_line::test
