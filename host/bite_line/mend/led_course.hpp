// SPDX-License-Identifier: MIT
#pragma once
/// \file The course of least cost between two places, led through others.

#include <optional>
#include <span>
#include <vector>

#include "host/bite_line/path/closed_path.hpp"

namespace biteline::mend {

/// The course must pass this column within `reach_rows` of the row.
struct Lead {
  int col{0};  ///< counted from the stretch's first column
  int row{0};
  int reach_rows{0};
};

/// `cost`: column after column of the stretch.  One row per column, from `first_row` to `last_row`; nothing
/// where no course with the configured steps meets every lead.  Of two leads in a column the later counts.
[[nodiscard]] std::optional<std::vector<int>> led_course(std::span<const float> cost, int rows, int first_row,
                                                         int last_row, std::span<const Lead> leads,
                                                         const bite_line::PathConfig& config);

}  // namespace biteline::mend
