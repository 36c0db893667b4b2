// SPDX-License-Identifier: MIT
#pragma once
/// \file Inner loops of the height field, the sections and the paths, in the widest vectors the machine has.

#include <cstddef>
#include <cstdint>
#include <span>

namespace biteline::groove {

/// to[i] += scale * from[i].  Pre: `from` has as many values as `to` and does not overlap it.
void add_scaled(std::span<float> to, const float* from, float scale);

/// One column of a path's dynamic programming.
struct ColumnStep {
  const float* before;             ///< totals of the column before; reach values below and above are readable
  std::span<const float> penalty;  ///< of steps -reach .. reach
  const float* own;                ///< the column's own cost
  float most;                      ///< totals do not grow beyond it
};
/// total[r] = min over d of before[r + d] + penalty[d], plus own[r]; step[r] = that d, the first of equals.
void step_column(const ColumnStep& column, std::span<float> total, std::int8_t* step);

}  // namespace biteline::groove
