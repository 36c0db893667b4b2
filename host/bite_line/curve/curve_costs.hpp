// SPDX-License-Identifier: MIT
#pragma once
/// \file The data term: what a millimetre of a curve costs at each place, in each direction.

#include <algorithm>

#include "host/bite_line/curve/crease_looks.hpp"
#include "host/bite_line/curve/raster.hpp"
#include "host/bite_line/pooled_vector.hpp"

namespace biteline::bite_line {

/// The logistic fits of bench_curve_fit.
[[nodiscard]] const CurveWeights& fitted_weights();

struct CurveCosts {
  int rows{0};
  int cols{0};
  /// Per cell and direction: minus the logarithm of the probability that the line passes there, against
  /// "surface".
  PooledVector<float> per_mm;

  /// Of all directions at a cell.
  [[nodiscard]] float least(std::size_t cell) const {
    const float* of_cell = &per_mm[cell * k_directions];
    return *std::min_element(of_cell, of_cell + k_directions);
  }
  [[nodiscard]] std::size_t at(int row, int col) const {
    return static_cast<std::size_t>(col) * static_cast<std::size_t>(rows) + static_cast<std::size_t>(row);
  }
  [[nodiscard]] float& of(std::size_t cell, std::size_t direction) {
    return per_mm[cell * k_directions + direction];
  }
  [[nodiscard]] float of(std::size_t cell, std::size_t direction) const {
    return per_mm[cell * k_directions + direction];
  }
};

/// Log odds that the line passes at a place, before anything was seen; the fit has as many of both.  The less
/// likely, the more a plain crease and a plainer one differ.
inline constexpr float k_line_log_odds = -1.0F;

/// Of a gap in the surface nothing is known: 0.5.  Below the shoe's lower edge and above its upper one there
/// is no surface to be seen; that costs as much as the plainest surface.
inline constexpr float k_unseen_cost_per_mm = 0.69F;
inline constexpr float k_most_cost_per_mm = 4.0F;

[[nodiscard]] CurveCosts curve_costs(const Raster& raster, CreaseLooks& looks, const CurveWeights& weights);

/// Once `looks` compare places with what the line usually shows: these costs anew.  What was as unlikely as
/// can be stays so.
void compare_costs(CurveCosts& costs, const Raster& raster, const CreaseLooks& looks);

}  // namespace biteline::bite_line
