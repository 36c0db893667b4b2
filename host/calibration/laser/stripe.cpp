// SPDX-License-Identifier: MIT
#include "host/calibration/laser/stripe.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <utility>

#include "common/stripe/peak_extractor.hpp"
#include "host/geometry/robust.hpp"

namespace biteline::calibration {

namespace {

/// The mean of a run about its own straight line; nothing when too few of its points agree on one.
std::vector<StripePoint> run_mean(const std::vector<StripePoint>& run) {
  constexpr std::size_t k_least_points = 3;
  if (run.size() < k_least_points) return {};
  // Theil's line: the median slope is not moved by single peaks on a speck.
  std::vector<double> slopes;
  for (std::size_t i = 0; i < run.size(); ++i) {
    for (std::size_t j = i + 1; j < run.size(); ++j) {
      const Vec2 d = run[j].pixel_px - run[i].pixel_px;
      if (d.x() > 0) slopes.push_back(d.y() / d.x());
    }
  }
  if (slopes.empty()) return {};
  const double slope = geometry::median_of(std::move(slopes));
  std::vector<double> offsets;
  for (const StripePoint& p : run) offsets.push_back(p.pixel_px.y() - slope * p.pixel_px.x());
  const double offset = geometry::median_of(offsets);
  Vec2 sum = Vec2::Zero();
  double weight_sum = 0, count = 0;
  for (std::size_t i = 0; i < run.size(); ++i) {
    if (std::abs(offsets[i] - offset) > std::max(0.3, 4 * run[i].sigma_px)) continue;
    const double weight = 1 / (run[i].sigma_px * run[i].sigma_px);
    sum += weight * run[i].pixel_px;
    weight_sum += weight;
    count += 1;
  }
  if (count < static_cast<double>(k_least_points)) return {};
  return {{.pixel_px = sum / weight_sum, .sigma_px = 1 / std::sqrt(weight_sum)}};
}

/// Peaks must stand out of this picture's own noise: 19 of 20 neighbours differ by no more than 2.8 of its
/// standard deviations; 1.8 where black cuts it off.
stripe::PeakConfig config_for(const image::GreyImage& picture) {
  constexpr double k_share = 0.95;
  std::array<std::size_t, 256> count{};
  std::size_t left = 0;
  for (std::size_t i = 1; i < picture.pixels.size(); ++i) {
    ++count[static_cast<std::size_t>(std::abs(picture.pixels[i] - picture.pixels[i - 1]))];
    ++left;
  }
  left -= static_cast<std::size_t>(k_share * static_cast<double>(left));
  int step_grey = 255;
  for (std::size_t beyond = 0; step_grey > 0; --step_grey) {
    beyond += count[static_cast<std::size_t>(step_grey)];
    if (beyond > left) break;
  }
  stripe::PeakConfig config;
  const auto step = static_cast<float>(step_grey);
  config.threshold_grey = std::clamp(3 * step, config.threshold_grey, 100.0F);
  config.noise.read_noise_grey = std::max(config.noise.read_noise_grey, step / 2.8F);
  return config;
}

}  // namespace

Result<PictureStripe> find_stripe(const image::GreyImage& picture) {
  BITELINE_ASSIGN(auto extractor,
                  stripe::PeakExtractor::create(config_for(picture), picture.width_px, picture.height_px));
  const auto peaks = std::make_unique<stripe::Peaks>();
  extractor.rt_extract(
      {.pixels = picture.pixels.data(), .stride_bytes = static_cast<std::size_t>(picture.width_px)}, *peaks);
  PictureStripe stripe;
  if (peaks->speckle.measured) stripe.speckle_contrast = static_cast<double>(peaks->speckle.contrast);
  for (int u = 0; u < peaks->column_count; ++u) {
    const stripe::ColumnPeaks& column = peaks->columns[static_cast<std::size_t>(u)];
    if (column.seen_count != 1 || column.kept_count != 1 || column.kept[0].flags != 0) continue;
    const stripe::Peak& peak = column.kept[0];
    // 0.02 px: what speckle and the surface leave however bright the stripe is.
    stripe.points.push_back({.pixel_px = Vec2(u, static_cast<double>(peak.row_px)),
                             .sigma_px = std::hypot(0.02, static_cast<double>(peak.sigma_row_px))});
  }
  return stripe;
}

std::vector<StripePoint> thin_stripe(const std::vector<StripePoint>& points, int columns) {
  std::vector<StripePoint> result, run;
  const auto close = [&] {
    for (const StripePoint& mean : run_mean(run)) result.push_back(mean);
    run.clear();
  };
  for (const StripePoint& point : points) {
    if (!run.empty()) {
      const Vec2 step = point.pixel_px - run.back().pixel_px;
      const bool apart = step.x() > 3 || std::abs(step.y()) > 4 * step.x() + 2;  // a gap, or another surface
      if (apart || point.pixel_px.x() - run.front().pixel_px.x() >= columns) close();
    }
    run.push_back(point);
  }
  close();
  return result;
}

bool runs_along_columns(const image::GreyImage& picture) {
  if (picture.pixels.empty()) return false;
  std::array<std::size_t, 256> count{};
  for (const std::uint8_t grey : picture.pixels) ++count[grey];
  std::size_t below = 0;
  int background = 0, brightest = 255;
  while (background < 255 &&
         (below += count[static_cast<std::size_t>(background)]) < picture.pixels.size() / 2)
    ++background;
  while (brightest > 0 && count[static_cast<std::size_t>(brightest)] == 0) --brightest;
  // A stripe stands out of the picture's background by more than noise does.
  constexpr int k_least_light_grey = 30, k_least_pixels = 50;
  if (brightest - background < k_least_light_grey) return false;
  const int bright = background + (brightest - background) / 2;
  double n = 0, u_sum = 0, uu = 0, v_sum = 0, vv = 0;
  for (int v = 0; v < picture.height_px; ++v) {
    const auto row = picture.row(v);
    for (int u = 0; u < picture.width_px; ++u) {
      if (row[static_cast<std::size_t>(u)] < bright) continue;
      n += 1;
      u_sum += u;
      uu += static_cast<double>(u) * u;
      v_sum += v;
      vv += static_cast<double>(v) * v;
    }
  }
  // Twice as high as it is wide: whole stripes are ten times as long as they are bent.
  constexpr double k_upright_ratio = 2;
  return n >= k_least_pixels &&
         vv - v_sum * v_sum / n > k_upright_ratio * k_upright_ratio * (uu - u_sum * u_sum / n);
}

}  // namespace biteline::calibration
