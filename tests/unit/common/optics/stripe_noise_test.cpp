// SPDX-License-Identifier: MIT
#include "common/optics/stripe_noise.hpp"

#include <CppUTest/TestHarness.h>

#include <cmath>
#include <numbers>

namespace biteline::optics {

TEST_GROUP(StripeNoise) {
  ScanLight light{.f_number = 5.6, .exposure_us = 400, .speed_mm_s = 100, .laser_mw = 5};
};

TEST(StripeNoise, OneRowIsWhatTheHandbookSays) {
  DOUBLES_EQUAL(0.104, row_mm(light), 0.0005);
  DOUBLES_EQUAL(0.122, row_mm({.focal_mm = 8, .pixel_um = 3.45}), 0.0005);
}

TEST(StripeNoise, SpeckleIsThatOfACentreOfGravity) {
  light.speed_mm_s = 0;
  const StripeNoise noise = stripe_noise(light);
  DOUBLES_EQUAL(noise.contrast_at_rest, noise.contrast, 1e-9);
  const double rows = rows_per_grain(speckle_optics(light));
  DOUBLES_EQUAL(row_mm(light) * noise.contrast * 0.37556 * std::sqrt(rows * noise.stripe_px),
                noise.speckle_mm, 1e-6);
  CHECK(noise.middle_mm >= noise.speckle_mm && noise.middle_mm >= noise.camera_mm);
}

TEST(StripeNoise, NoColumnFallsBelowDorschsLimit) {
  for (const double f_number : {2.8, 4.0, 5.6, 8.0}) {
    const StripeNoise noise = stripe_noise(with_f_number(light, f_number));
    CHECK(noise.middle_mm > noise.dorsch_mm);
  }
}

TEST(StripeNoise, DorschsLimitIsOfTheLightAndNotOfThePixel) {
  const double limit_mm = stripe_noise(light).dorsch_mm;
  light.pixel_um *= 2;
  DOUBLES_EQUAL(limit_mm, stripe_noise(light).dorsch_mm, 0.02 * limit_mm);
}

TEST(StripeNoise, AThinSheetComesNearDorschsLimit) {
  const StripeNoise thick = stripe_noise(light), thin = stripe_noise(with_stripe_mm(light, 0.2));
  CHECK(thick.middle_mm > 1.4 * thick.dorsch_mm);
  CHECK(thin.middle_mm < 1.2 * thin.dorsch_mm);
}

TEST(StripeNoise, ASheetWidensAsAGaussianBeam) {
  // 0.05 mm at half height: 0.0425 mm at 1 / e^2; 660 nm spread it by the root of 2 in pi 0.0425^2 / 0.66e-3
  // = 8.58 mm.
  light.stripe_mm = 0.05;
  light.f_number = 22;  // in focus all over
  light.range_mm = 2 * 8.58;
  const StripeNoise noise = stripe_noise(light);
  const double sheet_px = 0.05 / std::sqrt(8 * std::numbers::ln2) * 1000 * 12 / (200 * 4.4) * std::sqrt(0.5);
  const double lens_px = std::sqrt(std::pow(noise.stripe_px, 2) - sheet_px * sheet_px);
  // Of a disc of 144 * 6.07 / (22 * 188 * 193.93) mm, a quarter in 4.4 um.
  const double blur_px = 144 * 6.067 / (22 * 188 * 193.933) * 1000 / 4.4 / 4;
  DOUBLES_EQUAL(std::hypot(std::sqrt(2) * sheet_px, lens_px, blur_px), noise.end_stripe_px, 1e-3);
}

TEST(StripeNoise, PhotonsCountByTheirRoot) {
  light.read_noise_grey = 0;
  const StripeNoise once = stripe_noise(light);
  // Stripe of s pixels, A levels high, e electrons a level: A e s sqrt(2 pi) electrons, each within s.
  const double electrons = 120 * 40 * once.stripe_px * std::sqrt(2 * std::numbers::pi);
  DOUBLES_EQUAL(row_mm(light) * once.stripe_px / std::sqrt(electrons), once.camera_mm, 1e-9);
  light.grey *= 2;
  DOUBLES_EQUAL(once.camera_mm / std::sqrt(2), stripe_noise(light).camera_mm, 1e-9);
}

TEST(StripeNoise, MotionAverages) {
  const double still = stripe_noise(light).contrast_at_rest;
  double before = still;
  for (const double speed_mm_s : {100.0, 250.0, 1000.0}) {
    light.speed_mm_s = speed_mm_s;
    const StripeNoise noise = stripe_noise(light);
    DOUBLES_EQUAL(4e-4 * speed_mm_s, noise.moved_mm, 1e-9);
    CHECK(noise.contrast < before);
    before = noise.contrast;
  }
}

TEST(StripeNoise, OutOfFocusIsAsGeometryHasIt) {
  // f/2, 12 mm at 200 mm: a point 20 mm nearer makes a disc of 144 * 20 / (2 * 188 * 180) mm, 9.67 pixels.
  light.f_number = 2;
  light.range_mm = 40 * std::sqrt(2);
  const StripeNoise noise = stripe_noise(light);
  const double defocus_px = std::sqrt(std::pow(noise.end_stripe_px, 2) - std::pow(noise.stripe_px, 2));
  DOUBLES_EQUAL(9.67 / 4, defocus_px, 0.005);
}

TEST(StripeNoise, SaysWhatLimits) {
  const auto limit = [](const ScanLight& head) { return limit_of(head, stripe_noise(head)); };
  CHECK(limit(light) == NoiseLimit::Speckle);
  ScanLight dark = light;
  dark.grey = 2;
  CHECK(limit(dark) == NoiseLimit::Camera);
  ScanLight coarse = light;
  coarse.pixel_um = 40;
  coarse.stripe_mm = 0.05;
  CHECK(limit(coarse) == NoiseLimit::Pixels);
  ScanLight fast = light;
  fast.speed_mm_s = 2000;
  CHECK(limit(fast) == NoiseLimit::Motion);
  ScanLight deep = light;
  deep.f_number = 1.4;
  deep.range_mm = 200;
  CHECK(limit(deep) == NoiseLimit::DepthOfField);
}

TEST(StripeNoise, BrightnessIsKeptByTheExposure) {
  DOUBLES_EQUAL(100, with_f_number(light, 2.8).exposure_us, 1e-9);
  DOUBLES_EQUAL(800, with_laser_mw(light, 2.5).exposure_us, 1e-9);
  const ScanLight thin = with_stripe_mm(light, 0.2);
  DOUBLES_EQUAL(400 * stripe_noise(thin).stripe_px / stripe_noise(light).stripe_px, thin.exposure_us, 1e-9);
}

}  // namespace biteline::optics
