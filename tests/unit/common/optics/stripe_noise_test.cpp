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
}

TEST(StripeNoise, LaserClassIsOfWhatEntersTheEye) {
  // 90 degrees: a line of 200 mm at 100 mm, of which 7 mm enter.
  light.fan_rad = std::numbers::pi / 2;
  DOUBLES_EQUAL(5 * 7 / 200.0, eye_mw(light), 1e-9);
  CHECK(laser_class(light) == LaserClass::One);
  light.laser_mw = 20;
  CHECK(laser_class(light) == LaserClass::Two);
  light.laser_mw = 100;
  CHECK(laser_class(light) == LaserClass::ThreeR);
  light.laser_mw = 200;
  CHECK(laser_class(light) == LaserClass::ThreeB);
}

}  // namespace biteline::optics
