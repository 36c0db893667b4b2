// SPDX-License-Identifier: MIT
#pragma once
/// \file From log odds to a probability.

#include <algorithm>
#include <cmath>

namespace biteline::geometry {

/// 0.5 at 0, 0.88 at 2.  Beyond 40 either way nothing changes: 1 to the last bit, and no number too small.
[[nodiscard]] inline double logistic(double log_odds) {
  constexpr double k_certain = 40;
  return 1 / (1 + std::exp(-std::clamp(log_odds, -k_certain, k_certain)));
}

}  // namespace biteline::geometry
