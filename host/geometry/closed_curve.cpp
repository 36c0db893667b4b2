// SPDX-License-Identifier: MIT
#include "host/geometry/closed_curve.hpp"

namespace biteline::geometry {

std::vector<double> running_mean(std::span<const double> values, double window) {
  const double half = 0.5 * window;
  const auto whole = static_cast<std::ptrdiff_t>(half);
  const double edge = half - static_cast<double>(whole);
  std::vector<double> mean(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    double sum = 0;
    double weight = 0;
    for (std::ptrdiff_t j = -whole - 1; j <= whole + 1; ++j) {
      const double w = std::abs(j) <= whole ? 1.0 : edge;
      sum += w * values[round_index(i, j, values.size())];
      weight += w;
    }
    mean[i] = sum / weight;
  }
  return mean;
}

}  // namespace biteline::geometry
