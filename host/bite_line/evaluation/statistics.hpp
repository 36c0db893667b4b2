// SPDX-License-Identifier: MIT
#pragma once
/// \file Quantiles of a sample.

#include <algorithm>
#include <cmath>
#include <vector>

namespace biteline::evaluation {

/// Linear between the two nearest ranks.  Pre: `sorted` rises and is not empty, 0 <= share <= 1.
[[nodiscard]] inline double quantile(const std::vector<double>& sorted, double share) {
  const double place = share * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  return sorted[below] + (place - std::floor(place)) * (sorted[above] - sorted[below]);
}

}  // namespace biteline::evaluation
