// SPDX-License-Identifier: MIT
#include "host/geometry/closed_curve.hpp"

#include "host/geometry/robust.hpp"

namespace biteline::geometry {

std::vector<double> running_mean(std::span<const double> values, double window) {
  std::vector<double> mean(values.size(), 0.0);
  if (values.empty()) return mean;
  const double half = 0.5 * window;
  const auto whole = static_cast<std::ptrdiff_t>(half);
  const double edge = half - static_cast<double>(whole);
  const std::vector<double> round = once_more_round(values, whole + 1);
  const std::size_t last = 2 * static_cast<std::size_t>(whole + 1);
  double weight = 0;
  // Step by step of the window, so that all means grow side by side.
  for (std::size_t j = 0; j <= last; ++j) {
    const double w = j == 0 || j == last ? edge : 1.0;
    weight += w;
    for (std::size_t i = 0; i < mean.size(); ++i) mean[i] += w * round[i + j];
  }
  for (double& value : mean) value /= weight;
  return mean;
}

std::vector<double> running_median(std::span<const double> values, std::size_t beside) {
  std::vector<double> median;
  if (values.empty()) return median;
  median.reserve(values.size());
  const std::vector<double> round = once_more_round(values, static_cast<std::ptrdiff_t>(beside));
  std::vector<double> about;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto first = round.begin() + static_cast<std::ptrdiff_t>(i);
    about.assign(first, first + static_cast<std::ptrdiff_t>(2 * beside + 1));
    median.push_back(median_of(std::span<double>{about}));
  }
  return median;
}

}  // namespace biteline::geometry
