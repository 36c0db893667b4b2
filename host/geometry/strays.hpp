// SPDX-License-Identifier: MIT
#pragma once
/// \file Values round a closed line that stand out of those beside them.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace biteline::geometry {

struct SpikeLimits {
  std::size_t beside;  ///< values to either side that a value is compared with
  double most;         ///< from their median; more is a spike
};

/// The known values that are farther from the median of the known ones beside them than the limit, ascending.
[[nodiscard]] std::vector<std::size_t> spikes_of(std::span<const double> values,
                                                 std::span<const std::uint8_t> known,
                                                 const SpikeLimits& limits);

}  // namespace biteline::geometry
