// SPDX-License-Identifier: MIT
#include "host/study/performance.hpp"

#include <algorithm>
#include <cmath>

namespace biteline::study {

Result<Performance> performance(std::span<const double> values, const Limits& limits) {
  if (!(limits.low < limits.high))
    return fail(Errc::BadValue, "limits %.6g and %.6g: the lower one first", limits.low, limits.high);
  if (values.size() < 2) return fail(Errc::BadValue, "%zu values: at least 2 have a spread", values.size());
  const auto n = static_cast<double>(values.size());
  Performance result{.count = static_cast<int>(values.size())};
  for (const double value : values) {
    result.mean += value / n;
    if (value < limits.low || value > limits.high) ++result.outside;
  }
  double squares = 0;
  for (const double value : values) squares += (value - result.mean) * (value - result.mean);
  result.deviation = std::sqrt(squares / (n - 1));
  if (!(result.deviation > 0))
    return fail(Errc::BadValue, "all %zu values are equal: there is no spread", values.size());
  result.pp = (limits.high - limits.low) / (6 * result.deviation);
  result.ppk = std::min(limits.high - result.mean, result.mean - limits.low) / (3 * result.deviation);
  constexpr double k_one_sided_95 = 1.6448536269514722;
  result.ppk_low =
      result.ppk - k_one_sided_95 * std::sqrt(1 / (9 * n) + result.ppk * result.ppk / (2 * (n - 1)));
  return result;
}

}  // namespace biteline::study
