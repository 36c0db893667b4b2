// SPDX-License-Identifier: MIT
#include "host/bite_line/place/closed_path.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "common/core/contracts.hpp"
#include "host/bite_line/pooled_vector.hpp"
#include "host/bite_line/simd_kernels.hpp"

namespace biteline::bite_line {

namespace {

constexpr float k_blocked = 1e30F;

struct Sweep {
  std::vector<float> total;        ///< per row after the last column
  PooledVector<std::int8_t> step;  ///< per column and row: row of the previous column minus this row
};

/// Dynamic programming over `count` columns from column 0 (taken modulo cols); `start` gives the cost of each
/// first row.
Sweep sweep(std::span<const float> cost, int rows, int cols, int count, const std::vector<float>& start,
            const PathConfig& config) {
  Sweep result;
  result.step.assign(static_cast<std::size_t>(rows) * static_cast<std::size_t>(count), 0);
  const auto height = static_cast<std::size_t>(rows);
  const int reach = config.max_step_rows;
  // Blocked rows beyond both ends spare the inner loop its bounds.
  std::vector<float> before(height + 2 * static_cast<std::size_t>(reach), k_blocked);
  std::vector<float> after = before;
  std::vector<float> penalty;
  for (int d = -reach; d <= reach; ++d) penalty.push_back(static_cast<float>(config.step_cost * d * d));
  for (std::size_t r = 0; r < height; ++r) before[r + static_cast<std::size_t>(reach)] = start[r] + cost[r];
  for (int column = 1; column < count; ++column) {
    step_column({.before = before.data() + reach,
                 .penalty = penalty,
                 .own = cost.data() + static_cast<std::size_t>(column % cols) * height,
                 .most = k_blocked},
                {after.data() + reach, height},
                result.step.data() + static_cast<std::size_t>(column) * height);
    std::swap(before, after);
  }
  result.total.assign(before.begin() + reach, before.end() - reach);
  return result;
}

/// Rows from the last column back to the first, ending in `row`.
std::vector<int> trace_back(const Sweep& result, int rows, int count, int row) {
  std::vector<int> path(static_cast<std::size_t>(count));
  for (int column = count - 1; column >= 0; --column) {
    path[static_cast<std::size_t>(column)] = row;
    if (column > 0)
      row += result.step[static_cast<std::size_t>(column) * static_cast<std::size_t>(rows) +
                         static_cast<std::size_t>(row)];
  }
  return path;
}

/// The best of those that run through `row` of column 0.
ClosedPath closed_path_through(std::span<const float> cost, int rows, int cols, int row,
                               const PathConfig& config) {
  // Once round from the row back to the same row: cols + 1 columns, the last being the first again.
  const auto seam_row = static_cast<std::size_t>(row);
  std::vector<float> start(static_cast<std::size_t>(rows), k_blocked);
  start[seam_row] = 0;
  const Sweep once = sweep(cost, rows, cols, cols + 1, start, config);
  ClosedPath path;
  path.row = trace_back(once, rows, cols + 1, row);
  path.row.pop_back();
  path.cost = static_cast<double>(once.total[seam_row]) - static_cast<double>(cost[seam_row]);
  return path;
}

}  // namespace

ClosedPath shortest_closed_path(std::span<const float> cost, int rows, int cols, const PathConfig& config) {
  BITELINE_EXPECTS(rows > 0 && cols > 1 &&
                   cost.size() == static_cast<std::size_t>(rows) * static_cast<std::size_t>(cols));
  const std::vector<float> free_start(static_cast<std::size_t>(rows), 0.0F);
  const Sweep twice = sweep(cost, rows, cols, 2 * cols, free_start, config);
  const auto end =
      static_cast<int>(std::min_element(twice.total.begin(), twice.total.end()) - twice.total.begin());
  const int seam_row = trace_back(twice, rows, 2 * cols, end)[static_cast<std::size_t>(cols)];

  return closed_path_through(cost, rows, cols, seam_row, config);
}

}  // namespace biteline::bite_line
