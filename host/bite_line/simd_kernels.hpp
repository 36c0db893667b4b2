// SPDX-License-Identifier: MIT
#pragma once
/// \file Inner loops of the height field, the sections and the paths, in the widest vectors the machine has.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "host/bite_line/shoe/outline_lookup.hpp"

namespace biteline::bite_line {

/// Weights exp(-j^2 / 2 sigma^2) for j from -reach to reach, reach being `sigmas` standard deviations.
[[nodiscard]] std::vector<float> gaussian(double sigma_steps, double sigmas);

/// A row of values that goes into a sum, and how much it counts.
struct WeightedRow {
  const float* from;
  float weight;
};
/// to[i] = sum of weight * from[i] over the taps.  Pre: each `from` has as many values as `to` and does not
/// overlap it.
void sum_rows(std::span<float> to, std::span<const WeightedRow> taps);

/// The same for a kernel that slides along one row: to[i] = sum over j of kernel[j] * from[i + j].
void convolve(std::span<float> to, const float* from, std::span<const float> kernel);

/// Sums over weighted points: weight, place x, x^2, value, x value.
struct LineSums {
  const float *w, *x, *xx, *value, *x_value;
};
struct LineFit {
  float least_weight;  ///< lighter: 0, and not known
  float least_spread;  ///< points whose variance in x is smaller have their plain mean
};
/// The straight line through the points of each i, taken at x = 0.
void fit_lines(const LineSums& sums, const LineFit& fit, std::span<float> to, std::uint8_t* known);

/// A row of a grid: per cell the number of its points, the sums of their places from its middle, of their
/// values, and of both times each other.
struct RowOfSums {
  const float *w, *x, *value, *x_value;
  float weight;
  float at;  ///< its middle
};
/// The same through the points of all rows.  Known where they weigh enough and lie on both sides of 0.
void fit_rows(std::span<const RowOfSums> rows, const LineFit& fit, std::span<float> to, std::uint8_t* known);

/// to[i] = atan((high[i] - low[i]) * per_span) to 1e-5 rad.
void slope_angles(std::span<float> to, const float* low, const float* high, float per_span);

/// Curvature of a curve with `per_mm` values to a millimetre: to[i] of that through from[i] to from[i + 2].
void curvatures(std::span<float> to, const float* from, float per_mm);

/// A grid of `stations` along a closed path and `rows` in height about it.
struct PathGrid {
  struct Step {
    float z_mm;     ///< of the path at a station
    float rise_mm;  ///< from there to the next one, so that a sloping path leaves the sections level
  };
  std::span<const Step> steps;
  float rows, zero_row;
  float station_mm, per_row;
  float reach_o_mm;
};
/// Where a point falls on it.
struct Landing {
  std::int32_t station;  ///< negative: on none
  std::int32_t row;
  float s_mm;  ///< from the station's middle
  float o_mm;
};
void land(std::span<Landing> to, std::span<const OutlinePlace> places, const PathGrid& grid);

/// One column of a path's dynamic programming.
struct ColumnStep {
  const float* before;             ///< totals of the column before; reach values below and above are readable
  std::span<const float> penalty;  ///< of steps -reach .. reach
  const float* own;                ///< the column's own cost
  float most;                      ///< totals do not grow beyond it
};
/// total[r] = min over d of before[r + d] + penalty[d], plus own[r]; step[r] = that d, the first of equals.
void step_column(const ColumnStep& column, std::span<float> total, std::int8_t* step);

}  // namespace biteline::bite_line
