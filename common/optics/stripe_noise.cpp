// SPDX-License-Identifier: MIT
#include "common/optics/stripe_noise.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <numbers>

namespace biteline::optics {
namespace {

double square(double value) {
  return value * value;
}

/// The sheet's own width at so far from its waist over that at its waist, as a Gaussian beam's.
double spread_ratio(const ScanLight& light, double off_mm) {
  const double waist_mm = light.stripe_mm / std::sqrt(2 * std::numbers::ln2);  // half width at 1 / e^2
  return std::hypot(1, off_mm * 1e-6 * light.wavelength_nm / (std::numbers::pi * square(waist_mm)));
}

/// Standard deviation, in pixels, of what the lens makes of a point that far from focus, along the axis.
double defocus_px(const ScanLight& light, double off_mm) {
  const double disc_mm =
      square(light.focal_mm) * std::fabs(off_mm) /
      (light.f_number * (light.distance_mm - light.focal_mm) * (light.distance_mm + off_mm));
  return 1000 * disc_mm / light.pixel_um / 4;
}

double speckle_px(const StripeNoise& noise, double stripe_px, double grain_rows) {
  return noise.contrast * std::sqrt(grain_rows * stripe_px / (4 * std::sqrt(std::numbers::pi)));
}

double camera_px(const ScanLight& light, double stripe_px) {
  const double electrons =
      light.grey * light.electrons_per_grey * stripe_px * std::sqrt(2 * std::numbers::pi);
  return std::sqrt(square(stripe_px) / electrons +
                   2 * stripe_px * square(light.read_noise_grey / light.grey) / std::sqrt(std::numbers::pi));
}

}  // namespace

SpeckleOptics speckle_optics(const ScanLight& light) {
  return {.f_number = light.f_number,
          .magnification = light.focal_mm / (light.distance_mm - light.focal_mm),
          .pixel_um = light.pixel_um,
          .wavelength_nm = light.wavelength_nm};
}

double row_mm(const ScanLight& light) {
  return light.distance_mm * light.pixel_um / 1000 / (light.focal_mm * std::sin(light.angle_rad));
}

StripeNoise stripe_noise(const ScanLight& light) {
  const SpeckleOptics optics = speckle_optics(light);
  const double px_per_mm = 1000 * light.focal_mm / (light.distance_mm * light.pixel_um);
  // A surface across the laser plane is seen at the angle's cosine.
  const double seen_px_per_mm = px_per_mm * std::cos(light.angle_rad);
  StripeNoise noise;
  noise.moved_mm = 1e-6 * light.exposure_us * light.speed_mm_s;
  noise.contrast_at_rest = polarised_contrast(0) * pixel_contrast(optics);
  noise.contrast = polarised_contrast(0) * pixel_contrast(optics, noise.moved_mm * seen_px_per_mm);
  const double sheet_px = seen_px_per_mm * light.stripe_mm / std::sqrt(8 * std::numbers::ln2);
  // Lens and pixel, in focus: the grain's radius is 1.22 lambda N', its core as wide as a third of that.
  const double sharp_px = std::hypot(grain_um(optics) / light.pixel_um / 3, 1 / std::sqrt(12.0));
  noise.stripe_px = std::hypot(sheet_px, sharp_px);
  const double end_mm = 0.5 * light.range_mm * std::cos(light.angle_rad);
  noise.end_stripe_px = std::hypot(sheet_px * spread_ratio(light, 0.5 * light.range_mm), sharp_px,
                                   std::max(defocus_px(light, end_mm), defocus_px(light, -end_mm)));
  const double rows = rows_per_grain(optics), mm = row_mm(light);
  noise.speckle_mm = mm * speckle_px(noise, noise.stripe_px, rows);
  noise.end_speckle_mm = mm * speckle_px(noise, noise.end_stripe_px, rows);
  noise.camera_mm = mm * camera_px(light, noise.stripe_px);
  noise.pixel_mm = mm * std::exp(-2 * square(std::numbers::pi * noise.stripe_px)) / std::numbers::pi;
  noise.middle_mm = std::hypot(noise.speckle_mm, noise.camera_mm, noise.pixel_mm);
  noise.end_mm = std::hypot(noise.end_speckle_mm, mm * camera_px(light, noise.end_stripe_px));
  // The light's own contrast counts: a pixel that counts several grains makes no spot's place surer.
  noise.dorsch_mm = dorsch_limit_um(optics, polarised_contrast(0) * noise.contrast / noise.contrast_at_rest) /
                    1000 / std::sin(light.angle_rad);
  return noise;
}

NoiseLimit limit_of(const ScanLight& light, const StripeNoise& noise) {
  if (noise.moved_mm > light.stripe_mm) return NoiseLimit::Motion;
  if (noise.end_mm > 1.5 * noise.middle_mm) return NoiseLimit::DepthOfField;
  if (noise.speckle_mm >= std::max(noise.camera_mm, noise.pixel_mm)) return NoiseLimit::Speckle;
  return noise.camera_mm >= noise.pixel_mm ? NoiseLimit::Camera : NoiseLimit::Pixels;
}

ScanLight with_f_number(const ScanLight& light, double f_number) {
  ScanLight other = light;
  other.exposure_us *= square(f_number / light.f_number);
  other.f_number = f_number;
  return other;
}

ScanLight with_laser_mw(const ScanLight& light, double laser_mw) {
  ScanLight other = light;
  other.exposure_us *= light.laser_mw / laser_mw;
  other.laser_mw = laser_mw;
  return other;
}

ScanLight with_stripe_mm(const ScanLight& light, double stripe_mm) {
  ScanLight other = light;
  other.stripe_mm = stripe_mm;
  other.exposure_us *= stripe_noise(other).stripe_px / stripe_noise(light).stripe_px;
  return other;
}

}  // namespace biteline::optics
