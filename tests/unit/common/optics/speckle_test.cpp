// SPDX-License-Identifier: MIT
#include "common/optics/speckle.hpp"

#include <CppUTest/TestHarness.h>

#include <cmath>
#include <numbers>

namespace biteline::optics {

TEST_GROUP(OpticsSpeckle){/// The grain over the pixel's pitch.
                          static SpeckleOptics with_grain(double grain_per_pixel){SpeckleOptics optics;
optics.pixel_um = grain_um(optics) / grain_per_pixel;
return optics;
}  // namespace biteline::optics
}
;

TEST(OpticsSpeckle, GrainFollowsLensAndColour) {
  const SpeckleOptics red{.f_number = 5.6, .magnification = 0.0638, .wavelength_nm = 660};
  DOUBLES_EQUAL(1.22 * 0.66 * 5.6 * 1.0638, grain_um(red), 0.01);
  SpeckleOptics blue = red;
  blue.wavelength_nm = 440;
  DOUBLES_EQUAL(grain_um(red) * 2 / 3, grain_um(blue), 1e-9);
  DOUBLES_EQUAL(1, likeness(red, 0), 1e-12);
  DOUBLES_EQUAL(0, likeness(red, grain_um(red)), 1e-6);
}

TEST(OpticsSpeckle, AGrainMuchLargerThanThePixelHasAllTheContrast) {
  CHECK(pixel_contrast(with_grain(20)) > 0.99);
}

TEST(OpticsSpeckle, APixelMuchLargerThanTheGrainAveragesItsGrains) {
  // Goodman's M: the pixel's area over the area of likeness, lambda^2 N'^2 4 / pi.
  const SpeckleOptics optics = with_grain(0.1);
  const double area = std::pow(grain_um(optics) / 1.2197, 2) * 4 / std::numbers::pi;
  const double expected = std::sqrt(area) / optics.pixel_um;
  // The grains that the pixel's edges cut take a few per cent of it.
  DOUBLES_EQUAL(expected, pixel_contrast(optics), 0.06 * expected);
}

TEST(OpticsSpeckle, ALongWayAveragesAsManyPatternsAsItHasGrains) {
  const SpeckleOptics optics;
  const double still = pixel_contrast(optics);
  CHECK(pixel_contrast(optics, 0.3) < still);
  // Along the column, one after the other, as many pixels long as the way: the rows' sum is what stays alike.
  const double expected = still * std::sqrt(rows_per_grain(optics) / 20);
  DOUBLES_EQUAL(expected, pixel_contrast(optics, 20), 0.03 * expected);
}

TEST(OpticsSpeckle, DepolarisedLightIsTwoPatterns) {
  DOUBLES_EQUAL(std::sqrt(0.5), polarised_contrast(0), 1e-12);
  DOUBLES_EQUAL(1, polarised_contrast(1), 1e-12);
}

TEST(OpticsSpeckle, AWideSpectrumAveragesOnDeepSurfacesOnly) {
  const SpeckleOptics optics;
  DOUBLES_EQUAL(1, spectral_contrast(optics, {.spread_mm = 0, .line_width_nm = 5}), 1e-12);
  DOUBLES_EQUAL(1, spectral_contrast(optics, {.spread_mm = 0.2, .line_width_nm = 0}), 1e-12);
  // Far beyond the coherence length the contrast falls by the root of both.
  const double once = spectral_contrast(optics, {.spread_mm = 20, .line_width_nm = 2});
  DOUBLES_EQUAL(once / 2, spectral_contrast(optics, {.spread_mm = 40, .line_width_nm = 4}), 1e-3 * once);
  // 1 nm at 660 nm and 0.1 mm of paths, worked by hand: sigma 0.4247 nm, 6.126 rad/mm, 2 k s = 1.2252.
  DOUBLES_EQUAL(std::pow(1 + 1.2252 * 1.2252, -0.25),
                spectral_contrast(optics, {.spread_mm = 0.1, .line_width_nm = 1}), 1e-4);
}

TEST(OpticsSpeckle, DorschsLimit) {
  // f/4, 12 mm at 200 mm: the pupil's half, 1.5 mm, at 200 mm; 0.66 um / (2 pi 0.0075) = 14 um.
  DOUBLES_EQUAL(0.0075, aperture_sine({.f_number = 4}), 1e-5);
  DOUBLES_EQUAL(14.0, dorsch_limit_um({.f_number = 4}, 1), 0.05);
}

}  // namespace biteline::optics
