// SPDX-License-Identifier: MIT
// What skews a stripe: print that cuts it is flagged, nothing else is.
#include <CppUTest/TestHarness.h>

#include <cmath>
#include <functional>
#include <memory>
#include <numbers>

#include "common/stripe/peak_extractor.hpp"
#include "common/stripe/peak_selector.hpp"
#include "tests/support/made_stripe.hpp"

namespace biteline::stripe {
namespace {

constexpr int k_pictures = 5;
/// Where the print's edge meets the stripe.
constexpr int k_edge_column = 200;

test::MadeStripe made_stripe(double sigma_px, double speckle_contrast) {
  test::MadeStripe made;
  made.width_px = 400;
  made.sigma_px = sigma_px;
  made.amplitude = 150;
  made.noise.speckle_contrast = static_cast<float>(speckle_contrast);
  made.row_px = [](int u) { return 60 + 0.05 * u; };
  return made;
}

/// Black beyond a straight edge that comes to the stripe at this angle.
test::Albedo black_print(double angle_rad) {
  return [angle_rad](double u, double v) {
    return (u - k_edge_column) * std::sin(angle_rad) + (v - 70) * std::cos(angle_rad) > 0 ? 0.05 : 1.0;
  };
}

/// Errors in standard deviations of the stripe.
struct Found {
  double surface_rms{0}, all_rms{0};
  int surface{0}, flagged{0}, doubted{0};
};

Found find(const test::MadeStripe& made, const std::vector<double>& mean) {
  std::mt19937_64 random{5};
  const auto peaks = std::make_unique<Peaks>();
  const auto selection = std::make_unique<Selection>();
  auto extractor = PeakExtractor::create({.noise = made.noise}, made.width_px, made.height_px);
  CHECK(extractor.has_value());
  Found found;
  for (int picture = 0; picture < k_pictures; ++picture) {
    const std::vector<std::uint8_t> pixels = test::expose(made, mean, random);
    extractor->rt_extract({.pixels = pixels.data(), .stride_bytes = static_cast<std::size_t>(made.width_px)},
                          *peaks);
    const auto sut = std::make_unique<PeakSelector>(SelectorConfig{});
    sut->rt_select(*peaks, *selection);
    for (int u = 0; u < made.width_px; ++u) {
      const Selected& selected = selection->columns[static_cast<std::size_t>(u)];
      if (selected.kept_index < 0 || (selected.flags & ~k_selection_brightness_step) != 0) continue;
      const Peak& peak =
          peaks->columns[static_cast<std::size_t>(u)].kept[static_cast<std::size_t>(selected.kept_index)];
      if (peak.flags & k_peak_poor_fit) continue;
      const double error = std::pow((static_cast<double>(peak.row_px) - made.row_px(u)) / made.sigma_px, 2);
      found.all_rms += error;
      found.doubted += selected.skew_sigma_px > 0 ? 1 : 0;
      if (selected.flags != 0) {
        ++found.flagged;
      } else {
        ++found.surface;
        found.surface_rms += error;
      }
    }
  }
  found.all_rms = std::sqrt(found.all_rms / (found.surface + found.flagged));
  found.surface_rms = std::sqrt(found.surface_rms / found.surface);
  return found;
}

/// Light scattered to the higher rows from column `first` on: a fifth of the height, two standard deviations
/// aside and twice as wide.
std::vector<double> with_scattered_light(const test::MadeStripe& made, int first) {
  std::vector<double> mean(static_cast<std::size_t>(made.width_px * made.height_px), 0.0);
  test::add_stripe(made, mean);
  test::MadeStripe halo = made;
  halo.amplitude = 0.2 * made.amplitude;
  halo.sigma_px = 2 * made.sigma_px;
  halo.row_px = [&](int u) { return u < first ? -1000.0 : made.row_px(u) + 2 * made.sigma_px; };
  test::add_stripe(halo, mean);
  return mean;
}

}  // namespace

TEST_GROUP(PeakSkew){};

TEST(PeakSkew, WhatBlackPrintCutsIsFlaggedAndTheRestIsNot) {
  for (const double sigma_px : {1.4, 2.1, 3.5}) {
    for (const double angle_deg : {5.0, 15.0, 30.0}) {
      const test::MadeStripe made = made_stripe(sigma_px, 0.1);
      const double angle_rad = angle_deg * std::numbers::pi / 180;
      const Found found = find(made, test::on_surface(made, black_print(angle_rad)));
      const auto text =
          StringFromFormat("sigma %.1f px, %.0f deg: surface %.3f of %d, all %.3f, %d flagged", sigma_px,
                           angle_deg, found.surface_rms, found.surface, found.all_rms, found.flagged);
      // Without the flag a shallow edge bends the line by standard deviations of the stripe.
      CHECK_TEXT(found.all_rms > 0.09, text.asCharString());
      CHECK_TEXT(found.surface_rms < 0.4 * found.all_rms, text.asCharString());
      // The edge takes the stripe from three standard deviations before its centre to two behind, below which
      // nothing is left to see; a few columns more are looked at together.
      const double cut_columns = 5 * sigma_px / std::tan(angle_rad) + 6;
      CHECK_TEXT(found.flagged < k_pictures * cut_columns, text.asCharString());
      CHECK_TEXT(found.surface > k_pictures * (k_edge_column - cut_columns), text.asCharString());
    }
  }
}

TEST(PeakSkew, SpeckleCutsNothing) {
  for (const double sigma_px : {1.4, 2.1, 3.5}) {
    const test::MadeStripe made = made_stripe(sigma_px, 0.25);
    const Found found = find(made, test::on_surface(made, [](double, double) { return 1.0; }));
    CHECK(found.surface > k_pictures * 395);
    LONGS_EQUAL(0, found.flagged);
    CHECK_TEXT(found.doubted < 0.01 * found.surface,
               StringFromFormat("doubted %d", found.doubted).asCharString());
  }
}

TEST(PeakSkew, ASmoothGradientCutsNothing) {
  // To a third along the line, and across it from half as bright again to half as bright within two widths.
  const test::MadeStripe made = made_stripe(2.1, 0.1);
  const Found found = find(made, test::on_surface(made, [&](double u, double v) {
                             const double across =
                                 (v - made.row_px(static_cast<int>(u))) / (4.7 * made.sigma_px);
                             return (1 - u / 600) * std::clamp(1 - 0.5 * across, 0.0, 2.0);
                           }));
  CHECK(found.surface > k_pictures * 395);
  LONGS_EQUAL(0, found.flagged);
}

TEST(PeakSkew, MaterialThatScattersToOneSideIsMeasuredWithMoreDoubt) {
  const test::MadeStripe made = made_stripe(2.1, 0.1);
  const Found found = find(made, with_scattered_light(made, 250));
  LONGS_EQUAL(0, found.flagged);
  CHECK(found.doubted > k_pictures * 120);
}

TEST(PeakSkew, AHeadWhoseStripeIsSkewedEverywhereIsNoStep) {
  const test::MadeStripe made = made_stripe(2.1, 0.1);
  const Found found = find(made, with_scattered_light(made, 0));
  LONGS_EQUAL(0, found.flagged);
  CHECK_TEXT(found.doubted < 0.01 * found.surface,
             StringFromFormat("doubted %d", found.doubted).asCharString());
}

}  // namespace biteline::stripe
