// SPDX-License-Identifier: MIT
#include "host/geometry/closed_curve.hpp"

#include "host/geometry/robust.hpp"

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

std::vector<double> running_median(std::span<const double> values, std::size_t beside) {
  std::vector<double> median(values.size());
  std::vector<double> about;
  const auto reach = static_cast<std::ptrdiff_t>(beside);
  for (std::size_t i = 0; i < values.size(); ++i) {
    about.clear();
    for (std::ptrdiff_t j = -reach; j <= reach; ++j)
      about.push_back(values[round_index(i, j, values.size())]);
    median[i] = median_of(std::span<double>{about});
  }
  return median;
}

}  // namespace biteline::geometry
