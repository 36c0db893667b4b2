// SPDX-License-Identifier: MIT
#pragma once
/// \file Sums that a few wrong values do not spoil.

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "common/core/contracts.hpp"

namespace biteline::geometry {

/// The value that this share of all does not exceed (0: the least, 1: the largest).  Reorders; not empty.
template <class Value>
[[nodiscard]] Value quantile_of(std::span<Value> values, double share) {
  BITELINE_EXPECTS(!values.empty());
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// Of an even number the upper one of the two in the middle.  Reorders; not empty.
template <class Value>
[[nodiscard]] Value median_of(std::span<Value> values) {
  BITELINE_EXPECTS(!values.empty());
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}
template <class Value>
[[nodiscard]] Value median_of(std::vector<Value> values) {
  return median_of(std::span<Value>{values});
}

/// Standard deviation of normally distributed values over the median of their distances from their middle:
/// 1 / (the normal distribution's 0.75 quantile).
inline constexpr double k_sigma_per_mad = 1.4826;

}  // namespace biteline::geometry
