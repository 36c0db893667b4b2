// SPDX-License-Identifier: MIT
#pragma once
/// \file The best closed course round the side, and what else the line could be, stretch by stretch.

#include <span>
#include <vector>

#include "host/bite_line/path/closed_path.hpp"

namespace biteline::bite_line {

/// Another way over a part of the course, or all the way round: it leaves the course and comes back.
struct Branch {
  int first_col{0};
  std::vector<int> row;  ///< from first_col on, modulo the columns; all of them where it never comes back
  bool above{false};
  double worse{0};      ///< how much more it costs than the course over the same columns ...
  double over_cols{0};  ///< ... and over how many that is counted, several rounds where it never comes back
};

struct Course {
  std::vector<int> row;  ///< per column
  double cost{0};
  std::vector<Branch> branches;  ///< nearest rivals first
};

struct CourseConfig {
  PathConfig path{.max_step_rows = 4, .step_cost = 0.03};
  int apart_rows{8};      ///< what is nearer is the same line
  float most_cost{0.8F};  ///< of a place that shows something
  int most{80};           ///< branches to a side
};

/// Around the best course, shortest_closed_path() of the same cost and config.path.
///
/// Min-marginals of the chain: for each place the cheapest course through it, from sweeps twice round in both
/// directions.  Those that lie `apart_rows` and more away from the course at a column, on a place that shows
/// something, are its rivals there.
[[nodiscard]] Course find_course(std::span<const float> cost, int rows, int cols, const ClosedPath& best,
                                 const CourseConfig& config);

}  // namespace biteline::bite_line
