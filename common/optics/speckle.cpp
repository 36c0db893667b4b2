// SPDX-License-Identifier: MIT
#include "common/optics/speckle.hpp"

#include <cmath>
#include <numbers>

namespace biteline::optics {
namespace {

constexpr double k_nm_per_um = 1000;
/// Steps of a pixel, a side, in the sums below: 24 are good to a thousandth.
constexpr int k_steps = 24;

double image_f_number(const SpeckleOptics& optics) {
  return optics.f_number * (1 + optics.magnification);
}

double wavelength_um(const SpeckleOptics& optics) {
  return optics.wavelength_nm / k_nm_per_um;
}

/// Of two places drawn from a length evenly, how often they lie `part` of it apart: its density at 0 is 1.
double triangle(double part) {
  return std::fmax(0.0, 1 - std::fabs(part));
}

/// Likeness of what two pixels count, `down_px` apart in a column; not divided by a pixel's own.
double pixels_likeness(const SpeckleOptics& optics, double down_px) {
  double sum = 0;
  for (int i = -k_steps; i < k_steps; ++i) {
    for (int j = -k_steps; j < k_steps; ++j) {
      const double x_px = (i + 0.5) / k_steps, y_px = (j + 0.5) / k_steps;
      sum += triangle(x_px) * triangle(y_px) *
             likeness(optics, optics.pixel_um * std::hypot(x_px, y_px + down_px));
    }
  }
  return sum / (k_steps * k_steps);
}

}  // namespace

double aperture_sine(const SpeckleOptics& optics) {
  return optics.magnification / (2 * image_f_number(optics));
}

double grain_um(const SpeckleOptics& optics) {
  return 1.2197 * wavelength_um(optics) * image_f_number(optics);
}

double likeness(const SpeckleOptics& optics, double apart_um) {
  const double x = std::numbers::pi * std::fabs(apart_um) / (wavelength_um(optics) * image_f_number(optics));
  if (x < 1e-6) return 1;
  const double mu = 2 * ::j1(x) / x;
  return mu * mu;
}

double pixel_contrast(const SpeckleOptics& optics, double moved_px) {
  if (moved_px <= 0) return std::sqrt(pixels_likeness(optics, 0));
  // Two instants of the exposure see places apart by up to the whole way.
  const int steps = 8 + static_cast<int>(std::ceil(4 * moved_px));
  double sum = 0;
  for (int i = 0; i < steps; ++i) {
    const double part = (i + 0.5) / steps;
    sum += 2 * triangle(part) * pixels_likeness(optics, part * moved_px) / steps;
  }
  return std::sqrt(sum);
}

double rows_per_grain(const SpeckleOptics& optics) {
  constexpr int k_rows = 12;
  const double own = pixels_likeness(optics, 0);
  double sum = own;
  for (int row = 1; row <= k_rows; ++row) sum += 2 * pixels_likeness(optics, row);
  return sum / own;
}

double polarised_contrast(double polarised_ratio) {
  return std::sqrt((1 + polarised_ratio * polarised_ratio) / 2);
}

double spectral_contrast(const SpeckleOptics& optics, const Paths& paths) {
  // Wave numbers of a Gaussian line, rad/mm; paths of a Gaussian spread: two wave numbers' patterns are alike
  // by exp(-(dk s)^2), and the mean of that over the line's pairs is 1 / sqrt(1 + 4 k^2 s^2).
  const double wavelength_mm = 1e-6 * optics.wavelength_nm;
  const double sigma_nm = paths.line_width_nm / std::sqrt(8 * std::numbers::ln2);
  const double k_per_mm = 2 * std::numbers::pi * 1e-6 * sigma_nm / (wavelength_mm * wavelength_mm);
  return std::pow(1 + std::pow(2 * k_per_mm * paths.spread_mm, 2), -0.25);
}

double dorsch_limit_um(const SpeckleOptics& optics, double contrast) {
  return contrast * wavelength_um(optics) / (2 * std::numbers::pi * aperture_sine(optics));
}

}  // namespace biteline::optics
