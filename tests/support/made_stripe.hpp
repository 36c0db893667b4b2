// SPDX-License-Identifier: MIT
#pragma once
/// \file Made pictures of a stripe with known rows and known noise.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <random>
#include <vector>

#include "common/stripe/peak_extractor.hpp"

namespace biteline::stripe::test {

/// A Gaussian stripe of standard deviation `sigma_px`, as high as `amplitude` over `background`.
struct MadeStripe {
  int width_px{256};
  int height_px{128};
  double sigma_px{2.1};
  double amplitude{180};
  double background{0};
  NoiseModel noise{
      .read_noise_grey = 0.8F, .gain_grey_per_electron = 0.02F, .speckle_contrast = 0, .speckle_grain_px = 1};
  std::function<double(int)> row_px{[](int) { return 60.0; }};
};

/// Adds to `mean`, the noise-free grey values as real numbers.
inline void add_stripe(const MadeStripe& made, std::vector<double>& mean) {
  for (int u = 0; u < made.width_px; ++u) {
    const double centre = made.row_px(u);
    for (int v = 0; v < made.height_px; ++v) {
      const double x = (v - centre) / made.sigma_px;
      if (std::fabs(x) < 6)
        mean[static_cast<std::size_t>(v * made.width_px + u)] += made.amplitude * std::exp(-0.5 * x * x);
    }
  }
}

/// How much of the light comes back, by column and row.
using Albedo = std::function<double(double, double)>;

/// The stripe on a surface, seen through optics that blur by 0.6 px.
inline std::vector<double> on_surface(const MadeStripe& made, const Albedo& albedo) {
  constexpr double k_blur_px = 0.6, k_step_px = 0.3;
  std::vector<double> mean(static_cast<std::size_t>(made.width_px * made.height_px), 0.0);
  for (int u = 0; u < made.width_px; ++u) {
    for (int v = 0; v < made.height_px; ++v) {
      if (std::fabs(v - made.row_px(u)) > 6 * made.sigma_px) continue;
      double sum = 0, weights = 0;
      for (int a = -5; a <= 5; ++a) {
        for (int b = -5; b <= 5; ++b) {
          const double weight = std::exp(-0.5 * (a * a + b * b) * std::pow(k_step_px / k_blur_px, 2));
          const double x = (v + b * k_step_px - made.row_px(u)) / made.sigma_px;
          weights += weight;
          sum += weight * std::exp(-0.5 * x * x) * albedo(u + a * k_step_px, v + b * k_step_px);
        }
      }
      mean[static_cast<std::size_t>(v * made.width_px + u)] = made.amplitude * sum / weights;
    }
  }
  return mean;
}

/// Read noise, shot noise, speckle independent from pixel to pixel, then eight bits.
inline std::vector<std::uint8_t> expose(const MadeStripe& made, const std::vector<double>& mean,
                                        std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  std::vector<std::uint8_t> pixels(mean.size());
  for (std::size_t i = 0; i < mean.size(); ++i) {
    const double m = mean[i];
    const double variance = std::pow(made.noise.read_noise_grey, 2) + made.noise.gain_grey_per_electron * m +
                            std::pow(made.noise.speckle_contrast * m, 2);
    const double grey = made.background + m + std::sqrt(variance) * normal(random);
    pixels[i] = static_cast<std::uint8_t>(std::clamp(std::lround(grey), 0L, 255L));
  }
  return pixels;
}

inline std::vector<std::uint8_t> picture(const MadeStripe& made, std::mt19937_64& random) {
  std::vector<double> mean(static_cast<std::size_t>(made.width_px * made.height_px), 0.0);
  add_stripe(made, mean);
  return expose(made, mean, random);
}

/// Cramer-Rao bound on the row of one column, px: 1 / sqrt(sum (dm/dc)^2 / variance), over pixels below full
/// scale (Kay 1993, Estimation Theory, eq. (3.31) for independent Gaussian noise; quantisation adds 1/12 to
/// the read noise).
inline double cramer_rao_px(const MadeStripe& made, double centre) {
  double information = 0;
  for (int v = 0; v < made.height_px; ++v) {
    const double x = (v - centre) / made.sigma_px;
    if (std::fabs(x) > 6) continue;
    const double m = made.amplitude * std::exp(-0.5 * x * x), slope = m * x / made.sigma_px;
    if (made.background + m > 254.5) continue;
    information += slope * slope /
                   (std::pow(made.noise.read_noise_grey, 2) + 1.0 / 12 +
                    made.noise.gain_grey_per_electron * m + std::pow(made.noise.speckle_contrast * m, 2));
  }
  return 1 / std::sqrt(information);
}

}  // namespace biteline::stripe::test
