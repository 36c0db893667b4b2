// SPDX-License-Identifier: MIT
#include "host/bite_line/place/sampling.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "host/geometry/closed_curve.hpp"

namespace biteline::bite_line {

namespace {

constexpr double k_two_profiles_mm = 0.7;

/// Six points within the definition's Gaussian and these.
double sigma_of_six_mm(double points_per_mm2) {
  return 6.0 / (2.5 * std::max(points_per_mm2, 0.1));
}

}  // namespace

double sigma_along_mm(double points_per_mm2, double sample_mm) {
  constexpr double k_widest_mm = 2.0, k_of_sample = 0.4;
  return std::max(std::clamp(sigma_of_six_mm(points_per_mm2), k_two_profiles_mm, k_widest_mm),
                  k_of_sample * sample_mm);
}

bool are_few(double points_per_mm2) {
  return sigma_of_six_mm(points_per_mm2) > k_two_profiles_mm;
}

std::vector<double> between_profiles(std::span<const double> values, double sample_mm, double station_mm) {
  const std::size_t count = values.size();
  const auto lag = static_cast<std::size_t>(std::lround(sample_mm / station_mm));
  std::vector<double> square(count, 0.0);
  if (lag == 0 || 2 * lag >= count) return square;
  for (std::size_t i = 0; i < count; ++i) {
    const double bend = values[(i + count - lag) % count] - 2 * values[i] + values[(i + lag) % count];
    square[i] = bend * bend;
  }
  std::vector<double> sigma = geometry::running_mean(square, 2 * static_cast<double>(lag));
  for (double& value : sigma) value = std::sqrt(8.0 / 15 * std::max(value, 0.0)) / 8;
  return sigma;
}

}  // namespace biteline::bite_line
