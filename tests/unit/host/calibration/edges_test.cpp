// SPDX-License-Identifier: MIT
#include "host/calibration/rings/edges.hpp"

#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>

namespace biteline::calibration {

/// A dark disc whose rim the lens blurs, under light that a test chooses.
TEST_GROUP(Edges) {
  static constexpr int k_size_px = 161;
  static constexpr double k_radius_px = 50, k_blur_px = 1.5, k_dark_grey = 25, k_bright_grey = 165;
  const Vec2 centre_px{80.3, 79.6};
  std::mt19937_64 random{7};

  /// The lens's blur across the rim; the rest of it, which makes the sums exact, is in the print.
  static constexpr double k_print_blur_px = 0.3;
  static constexpr int k_nodes = 65;

  /// `light` turns the level that even light shows at a place into the one shown there, before the blur.
  image::GreyImage picture(const std::function<double(const Vec2&, double)>& light) {
    std::uniform_real_distribution<double> dither(-0.5, 0.5);
    const double lens_blur_px = std::sqrt(k_blur_px * k_blur_px - k_print_blur_px * k_print_blur_px);
    image::GreyImage result{.width_px = k_size_px, .height_px = k_size_px, .pixels = {}};
    for (int v = 0; v < k_size_px; ++v) {
      for (int u = 0; u < k_size_px; ++u) {
        const Vec2 outward = (Vec2(u, v) - centre_px).normalized();
        double sum = 0, weights = 0;
        for (int k = 0; k < k_nodes; ++k) {
          const double sigmas = 8.0 * k / (k_nodes - 1) - 4, weight = std::exp(-0.5 * sigmas * sigmas);
          const Vec2 place = Vec2(u, v) + lens_blur_px * sigmas * outward;
          const double beyond_sigmas =
              std::clamp(((place - centre_px).dot(outward) - k_radius_px) / k_print_blur_px, -8.0, 8.0);
          const double share = 0.5 * std::erfc(-beyond_sigmas / std::numbers::sqrt2);
          sum += weight * light(place, k_dark_grey + share * (k_bright_grey - k_dark_grey));
          weights += weight;
        }
        result.pixels.push_back(
            static_cast<std::uint8_t>(std::clamp(std::lround(sum / weights + dither(random)), 0L, 255L)));
      }
    }
    return result;
  }

  double centre_error_px(const image::GreyImage& image) {
    const Ellipse rim{.centre = centre_px, .major_semi = k_radius_px, .minor_semi = k_radius_px};
    const std::vector<Vec2> points = edge_points(image, rim, {.reach_px = 9});
    const std::optional<Ellipse> fit = fit_ellipse(points);
    CHECK(fit.has_value());
    return (fit->centre - centre_px).norm();
  }

  /// Rounding and dither: 0.41 grey levels where the rim rises by 37 per pixel; some 300 points, two
  /// unknowns; four of these.
  static constexpr double k_noise_px = 4 * 0.41 / 37 * 0.115;
};

TEST(Edges, LightThatFallsOffMovesNoCentre) {
  // Half way between sides read 8 px apart from the rim, uncorrected: 0.04 px.
  const auto falls_off = [&](const Vec2& place, double level) {
    return level * (1 + 0.003 * (place.x() - centre_px.x()));
  };
  CHECK(centre_error_px(picture(falls_off)) < k_noise_px);
}

TEST(Edges, AddedLightMovesNoCentre) {
  const auto haze = [&](const Vec2& place, double level) {
    return level + 0.4 * (place.y() - centre_px.y());
  };
  CHECK(centre_error_px(picture(haze)) < k_noise_px);
}

TEST(Edges, GlareThatCutsTheBrightSideCostsOnlyItsOwnPlaces) {
  // Half way between the dark side and 255 is not half way: 0.6 px with those places.  Beside them the glare
  // still bends by up to 0.2 grey levels per px^2: 0.14 px at an eighth of the rim, of which the centre takes
  // a quarter.
  const auto glare = [&](const Vec2& place, double level) {
    const double d_px = (place - centre_px - Vec2(70, 0)).norm();
    return level + 300 * std::exp(-0.5 * std::pow(std::min(8.0, d_px / 25), 2));
  };
  CHECK(centre_error_px(picture(glare)) < 0.035);
}

TEST(Edges, RimCutAllRoundIsStillSeen) {
  const auto bright = [](const Vec2&, double level) { return 2 * level; };
  CHECK(centre_error_px(picture(bright)) < k_noise_px);
}

}  // namespace biteline::calibration
