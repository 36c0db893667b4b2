// SPDX-License-Identifier: MIT
// The speckle that a stripe shows of itself, and what follows from it: standard deviations and flags.
#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <vector>

#include "common/stripe/peak_extractor.hpp"
#include "common/stripe/peak_selector.hpp"
#include "tests/support/made_stripe.hpp"

namespace biteline::stripe {
namespace {

constexpr int k_width_px = 512, k_height_px = 96, k_stripes = 6;

/// Brightness of a speckle pattern: the mean of so many unrelated ones, whose contrast is 1 / sqrt(looks)
/// (Goodman 2007, section 3.3).  With a blur each is the intensity of a complex field blurred by a Gaussian
/// of that standard deviation, without one each pixel is its own.
std::vector<double> speckled(int looks, double blur_px, std::mt19937_64& random) {
  std::vector<double> light(k_width_px * k_height_px, 0.0);
  if (blur_px == 0) {
    std::gamma_distribution<double> mean_of_looks{static_cast<double>(looks), 1.0 / looks};
    for (double& value : light) value = mean_of_looks(random);
    return light;
  }
  constexpr int k_reach = 3;
  std::array<double, 2 * k_reach + 1> kernel{};
  double power = 0;
  for (int k = -k_reach; k <= k_reach; ++k) {
    kernel[static_cast<std::size_t>(k + k_reach)] = std::exp(-0.5 * k * k / (blur_px * blur_px));
    power += std::exp(-1.0 * k * k / (blur_px * blur_px));
  }
  std::normal_distribution<double> normal;
  for (int part = 0; part < 2 * looks; ++part) {  // real and imaginary
    std::vector<double> field(light.size()), along(light.size());
    for (double& value : field) value = normal(random);
    const auto blurred = [&](const std::vector<double>& from, int u, int v, int du, int dv) {
      double sum = 0;
      for (int k = -k_reach; k <= k_reach; ++k) {
        const int x = (u + k * du + k_width_px) % k_width_px, y = (v + k * dv + k_height_px) % k_height_px;
        sum += from[static_cast<std::size_t>(y * k_width_px + x)] *
               kernel[static_cast<std::size_t>(k + k_reach)];
      }
      return sum;
    };
    for (std::size_t i = 0; i < light.size(); ++i)
      along[i] = blurred(field, static_cast<int>(i) % k_width_px, static_cast<int>(i) / k_width_px, 1, 0);
    for (std::size_t i = 0; i < light.size(); ++i) {
      const double value =
          blurred(along, static_cast<int>(i) % k_width_px, static_cast<int>(i) / k_width_px, 0, 1);
      light[i] += value * value / (2 * looks * power * power);
    }
  }
  return light;
}

struct Seen {
  double contrast{0}, ratio_68{0};
  double kept_ratio{0};  ///< of all columns: chosen and not flagged
};

Seen see(int looks, double blur_px, const std::function<double(int)>& albedo, double amplitude = 90) {
  std::mt19937_64 random{11};
  const std::vector<double> speckle = speckled(looks, blur_px, random);
  test::MadeStripe made;
  made.width_px = k_width_px;
  made.height_px = k_height_px;
  made.amplitude = amplitude;
  auto extractor = PeakExtractor::create({}, k_width_px, k_height_px);
  CHECK(extractor.has_value());
  const auto peaks = std::make_unique<Peaks>();
  const auto selection = std::make_unique<Selection>();
  Seen seen;
  std::vector<double> ratios;
  for (int picture = 0; picture < k_stripes; ++picture) {
    // A stripe elsewhere on the pattern meets other speckle.
    made.row_px = [picture](int u) { return 15 + 9.37 * picture + 0.013 * u; };
    std::vector<double> mean(speckle.size(), 0.0);
    test::add_stripe(made, mean);
    for (std::size_t i = 0; i < mean.size(); ++i)
      mean[i] *= speckle[i] * albedo(static_cast<int>(i) % k_width_px);
    const std::vector<std::uint8_t> pixels = test::expose(made, mean, random);
    extractor->rt_extract({.pixels = pixels.data(), .stride_bytes = k_width_px}, *peaks);
    const auto selector = std::make_unique<PeakSelector>(SelectorConfig{});
    selector->rt_select(*peaks, *selection);
    CHECK(peaks->speckle.measured);
    seen.contrast += static_cast<double>(peaks->speckle.contrast) / k_stripes;
    for (int u = 0; u < k_width_px; ++u) {
      const Selected& selected = selection->columns[static_cast<std::size_t>(u)];
      if (selected.kept_index < 0 || selected.flags != 0) continue;
      const Peak& peak =
          peaks->columns[static_cast<std::size_t>(u)].kept[static_cast<std::size_t>(selected.kept_index)];
      ratios.push_back(std::fabs(static_cast<double>(peak.row_px) - made.row_px(u)) /
                       static_cast<double>(peak.sigma_row_px));
    }
  }
  std::sort(ratios.begin(), ratios.end());
  seen.ratio_68 = ratios[ratios.size() * 683 / 1000];
  seen.kept_ratio = static_cast<double>(ratios.size()) / (k_stripes * k_width_px);
  return seen;
}

double even(int) {
  return 1;
}

}  // namespace

TEST_GROUP(StripeSpeckle){};

TEST(StripeSpeckle, IsMeasuredAndEachRowSaysHowSureItIs) {
  // A grain of a pixel, and one of several.
  struct Row {
    int looks;
    double blur_px;
  };
  for (const Row& row : {Row{400, 0}, Row{44, 0}, Row{14, 0}, Row{5, 0}, Row{3, 0}, Row{14, 1}}) {
    const Seen seen = see(row.looks, row.blur_px, even);
    const double contrast = 1 / std::sqrt(row.looks);
    const auto text = StringFromFormat("contrast %.3f, blur %.1f: seen %.3f, ratio %.2f, kept %.4f", contrast,
                                       row.blur_px, seen.contrast, seen.ratio_68, seen.kept_ratio);
    CHECK_TEXT(std::fabs(seen.contrast - contrast) < 0.15 * contrast, text.asCharString());
    CHECK_TEXT(seen.ratio_68 > 0.8 && seen.ratio_68 < 1.2, text.asCharString());
    // At rest and at a small stop the shape itself begins to be lost.
    CHECK_TEXT(seen.kept_ratio > (contrast > 0.5 ? 0.94 : 0.95), text.asCharString());
  }
}

TEST(StripeSpeckle, GrainsAtFullScaleAreReckonedWith) {
  // Up to two fifths of the crest are cut off at 255.
  for (const double amplitude : {170.0, 200.0, 230.0}) {
    for (const int looks : {14, 5}) {
      const Seen seen = see(looks, 0, even, amplitude);
      const double contrast = 1 / std::sqrt(looks);
      const auto text =
          StringFromFormat("contrast %.3f, amplitude %.0f: seen %.3f", contrast, amplitude, seen.contrast);
      CHECK_TEXT(std::fabs(seen.contrast - contrast) < 0.15 * contrast, text.asCharString());
    }
  }
}

TEST(StripeSpeckle, PrintAndShadeAreNone) {
  // Bright and dark bars of 120 columns, and light that falls to a third along the stripe.
  const auto printed = [](int u) { return (u / 120 % 2 == 0 ? 1.0 : 0.4) * (1 - u / 768.0); };
  const Seen seen = see(44, 0, printed);
  DOUBLES_EQUAL(0.15, seen.contrast, 0.15 * 0.15);
}

TEST(StripeSpeckle, TooFewColumnsLeaveWhatIsExpected) {
  test::MadeStripe made;
  made.width_px = 40;
  std::mt19937_64 random{4};
  const std::vector<std::uint8_t> pixels = test::picture(made, random);
  auto sut = PeakExtractor::create({.noise = {.speckle_contrast = 0.2F}}, made.width_px, made.height_px);
  CHECK(sut.has_value());
  const auto peaks = std::make_unique<Peaks>();
  sut->rt_extract({.pixels = pixels.data(), .stride_bytes = 40}, *peaks);
  CHECK(!peaks->speckle.measured);
  DOUBLES_EQUAL(0.2, static_cast<double>(peaks->speckle.contrast), 1e-6);
}

}  // namespace biteline::stripe
