// SPDX-License-Identifier: MIT
#pragma once
/// \file Closed polylines: the last point is joined to the first.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace biteline::geometry {

/// A place on a closed polyline: `share` of the way from one of its points to the next.
struct OnCurve {
  std::size_t before;
  std::size_t after;
  double share;

  template <class Value>
  [[nodiscard]] Value between(const Value& a, const Value& b) const {
    return (1 - share) * a + share * b;
  }
};

/// Arc length along a closed polyline.
class ArcLength {
 public:
  /// `position_of(i)`: of the i-th of `count` points, at least one.
  template <class PositionOf>
  ArcLength(std::size_t count, PositionOf&& position_of) : at_mm_(count + 1, 0.0) {
    for (std::size_t i = 0; i < count; ++i)
      at_mm_[i + 1] = at_mm_[i] + (position_of((i + 1) % count) - position_of(i)).norm();
  }

  [[nodiscard]] double total_mm() const { return at_mm_.back(); }

  /// `mm` from 0 to total_mm().
  [[nodiscard]] OnCurve at(double mm) const {
    const auto above = std::upper_bound(at_mm_.begin() + 1, at_mm_.end() - 1, mm);
    return behind(static_cast<std::size_t>(above - at_mm_.begin()) - 1, mm);
  }

  /// The k-th of `count` evenly spaced places.
  [[nodiscard]] OnCurve even(std::size_t k, std::size_t count) const {
    return at(total_mm() * static_cast<double>(k) / static_cast<double>(count));
  }
  /// All of them.
  [[nodiscard]] std::vector<OnCurve> even(std::size_t count) const {
    std::vector<OnCurve> places;
    places.reserve(count);
    std::size_t before = 0;
    for (std::size_t k = 0; k < count; ++k) {
      const double mm = total_mm() * static_cast<double>(k) / static_cast<double>(count);
      while (before + 2 < at_mm_.size() && at_mm_[before + 1] <= mm) ++before;
      places.push_back(behind(before, mm));
    }
    return places;
  }

  /// How many evenly spaced points come nearest to this spacing; at least three make a closed line.
  [[nodiscard]] std::size_t count_for(double spacing_mm) const {
    return static_cast<std::size_t>(std::max(3.0, std::round(total_mm() / spacing_mm)));
  }

 private:
  [[nodiscard]] OnCurve behind(std::size_t before, double mm) const {
    const double step_mm = std::max(at_mm_[before + 1] - at_mm_[before], 1e-12);
    return {.before = before,
            .after = before + 2 < at_mm_.size() ? before + 1 : 0,
            .share = std::clamp((mm - at_mm_[before]) / step_mm, 0.0, 1.0)};
  }

  std::vector<double> at_mm_;  ///< per point, and of the first one again
};

/// Index `by` places on, round `count`; `by` may be negative.
[[nodiscard]] inline std::size_t round_index(std::size_t i, std::ptrdiff_t by, std::size_t count) {
  const auto n = static_cast<std::ptrdiff_t>(count);
  return static_cast<std::size_t>(((static_cast<std::ptrdiff_t>(i) + by) % n + n) % n);
}

/// Closed data with the `beside` ones from their other end before their begin and behind their end; not
/// empty.
template <class Value>
[[nodiscard]] std::vector<Value> once_more_round(std::span<const Value> values, std::ptrdiff_t beside) {
  std::vector<Value> round;
  round.reserve(values.size() + 2 * static_cast<std::size_t>(beside));
  for (std::ptrdiff_t i = -beside; i < 0; ++i) round.push_back(values[round_index(0, i, values.size())]);
  round.insert(round.end(), values.begin(), values.end());
  for (std::ptrdiff_t i = 0; i < beside; ++i) round.push_back(values[round_index(0, i, values.size())]);
  return round;
}

/// Gaussian mean round closed data; `sigma_samples` in steps.  `zero`: of the values' kind.
template <class Value>
[[nodiscard]] std::vector<Value> smooth_closed(std::span<const Value> values, double sigma_samples,
                                               const Value& zero) {
  const auto reach = static_cast<std::ptrdiff_t>(std::ceil(3.5 * sigma_samples));
  std::vector<double> kernel;
  double sum = 0;
  for (std::ptrdiff_t j = -reach; j <= reach; ++j) {
    kernel.push_back(std::exp(-0.5 * std::pow(static_cast<double>(j) / std::max(sigma_samples, 1e-9), 2)));
    sum += kernel.back();
  }
  std::vector<Value> smooth(values.size(), zero);
  if (values.empty()) return smooth;
  const std::vector<Value> round = once_more_round(values, reach);
  for (std::size_t j = 0; j < kernel.size(); ++j) {
    const double share = kernel[j] / sum;
    for (std::size_t i = 0; i < smooth.size(); ++i) smooth[i] += share * round[i + j];
  }
  return smooth;
}
[[nodiscard]] inline std::vector<double> smooth_closed(std::span<const double> values, double sigma_samples) {
  return smooth_closed<double>(values, sigma_samples, 0.0);
}

/// Mean over `window` steps round closed data; fractional at the ends so that the window is exact.
[[nodiscard]] std::vector<double> running_mean(std::span<const double> values, double window);

/// Median of each value and the `beside` ones to either side, round closed data.
[[nodiscard]] std::vector<double> running_median(std::span<const double> values, std::size_t beside);

}  // namespace biteline::geometry
