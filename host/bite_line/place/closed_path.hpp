// SPDX-License-Identifier: MIT
#pragma once
/// \file The globally best closed path once round a cylinder.

#include <span>
#include <vector>

namespace biteline::bite_line {

struct ClosedPath {
  std::vector<int> row;  ///< per column
  double cost{0};
};

struct PathConfig {
  int max_step_rows{3};    ///< from column to column
  double step_cost{0.02};  ///< per squared row of a step
};

/// Path of least total cost through `cost` (rows x cols, column after column), one row per column, whose end
/// joins its start.
///
/// Dynamic programming twice round finds where the best path crosses the seam; once more from there closes
/// it.  Exact whenever the path twice round repeats itself at the seam, which it does unless two paths tie;
/// the closing pass makes the result closed in any case.  Cost: 3 rows cols (2 max_step_rows + 1).
[[nodiscard]] ClosedPath shortest_closed_path(std::span<const float> cost, int rows, int cols,
                                              const PathConfig& config);

}  // namespace biteline::bite_line
