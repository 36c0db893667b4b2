// SPDX-License-Identifier: MIT
#pragma once
/// \file How well a process keeps its limits over many parts: Pp and Ppk (ISO 22514-2; AIAG, SPC, 2nd
/// edition).
///
/// The spread is that of all parts, drift included.  The indices tell shares of bad parts only where the
/// values are near to normal, and tomorrow is like today.

#include <span>

#include "common/core/result.hpp"

namespace biteline::study {

struct Limits {
  double low{0}, high{0};
};

struct Performance {
  int count{0};
  double mean{0}, deviation{0};  ///< standard deviation, of n - 1
  double pp{0};                  ///< (high - low) / (6 s)
  double ppk{0};                 ///< (distance of the mean to the nearer limit) / (3 s)
  double ppk_low{0};  ///< with 95 % the true Ppk is not below: Bissell, Applied Statistics 39, 331 (1990)
  int outside{0};     ///< values beyond a limit
};

/// Fails: fewer than 2 values, no spread at all, or limits that are not in order.
[[nodiscard]] Result<Performance> performance(std::span<const double> values, const Limits& limits);

}  // namespace biteline::study
