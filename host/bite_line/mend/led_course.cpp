// SPDX-License-Identifier: MIT
#include "host/bite_line/mend/led_course.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <limits>

#include "common/core/contracts.hpp"

namespace biteline::mend {

std::optional<std::vector<int>> led_course(std::span<const float> cost, int rows, int first_row, int last_row,
                                           std::span<const Lead> leads, const bite_line::PathConfig& config) {
  BITELINE_EXPECTS(rows > 0 && !cost.empty() && cost.size() % static_cast<std::size_t>(rows) == 0);
  constexpr float k_blocked = std::numeric_limits<float>::infinity();
  const auto height = static_cast<std::size_t>(rows);
  const std::size_t cols = cost.size() / height;
  std::vector<Lead> at(cols, Lead{.col = 0, .row = 0, .reach_rows = rows});
  for (const Lead& lead : leads) {
    if (lead.col < 0 || static_cast<std::size_t>(lead.col) >= cols) return std::nullopt;
    at[static_cast<std::size_t>(lead.col)] = lead;
  }
  at.front() = {.col = 0, .row = first_row, .reach_rows = 0};
  at.back() = {.col = static_cast<int>(cols) - 1, .row = last_row, .reach_rows = 0};

  std::vector<float> before(height, k_blocked), after(height, k_blocked);
  std::vector<std::int8_t> step(height * cols, 0);
  for (std::size_t col = 0; col < cols; ++col) {
    for (int row = 0; row < rows; ++row) {
      float best = col == 0 ? 0.0F : k_blocked;
      int best_step = 0;
      for (int d = -config.max_step_rows; col > 0 && d <= config.max_step_rows; ++d) {
        if (row + d < 0 || row + d >= rows) continue;
        const float total =
            before[static_cast<std::size_t>(row + d)] + static_cast<float>(config.step_cost * d * d);
        if (total < best) {
          best = total;
          best_step = d;
        }
      }
      const bool open = std::abs(row - at[col].row) <= at[col].reach_rows;
      const std::size_t cell = col * height + static_cast<std::size_t>(row);
      after[static_cast<std::size_t>(row)] = open ? best + cost[cell] : k_blocked;
      step[cell] = static_cast<std::int8_t>(best_step);
    }
    std::swap(before, after);
  }
  if (last_row < 0 || last_row >= rows || !(before[static_cast<std::size_t>(last_row)] < k_blocked))
    return std::nullopt;
  std::vector<int> course(cols);
  int row = last_row;
  for (std::size_t col = cols; col-- > 0;) {
    course[col] = row;
    row += step[col * height + static_cast<std::size_t>(row)];
  }
  return course;
}

}  // namespace biteline::mend
