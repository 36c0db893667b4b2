// SPDX-License-Identifier: MIT
#include "host/calibration/rings/edges.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "host/geometry/symmetric.hpp"

namespace biteline::calibration {

namespace {

/// A step of less is no edge of a ring (dark print on bright paper, any sensible exposure).
constexpr double k_least_step_grey = 12;
constexpr double k_sample_step_px = 0.25;
/// From here on the picture may be cut: how bright the paper is, and so where half way is, is not known.
constexpr double k_cut_grey = 253;
/// Share of an edge's places that must be free of cut levels for the others to be left out.
constexpr double k_least_uncut_ratio = 0.6;

/// Bilinear.  Pre: 0 <= u < width - 1, 0 <= v < height - 1.
double level_at(const image::GreyImage& picture, double u_px, double v_px) {
  const int u = static_cast<int>(u_px), v = static_cast<int>(v_px);
  const double fu = u_px - u, fv = v_px - v;
  const std::uint8_t* p =
      picture.pixels.data() + static_cast<std::size_t>(v) * static_cast<std::size_t>(picture.width_px) + u;
  const std::uint8_t* q = p + picture.width_px;
  return (1 - fv) * ((1 - fu) * p[0] + fu * p[1]) + fv * ((1 - fu) * q[0] + fu * q[1]);
}

/// One place of an edge, seen along the ellipse's normal towards the bright side.
struct Step {
  Vec2 on_px{Vec2::Zero()};  ///< of the ellipse
  Vec2 towards_bright{Vec2::Zero()};
  double place_px{0};      ///< of the half-way crossing beyond the ellipse
  double slope_per_px{0};  ///< there
  double low{0}, high{0};  ///< levels of the two sides, grey
  bool cut{false};         ///< the bright side is: its level, and so where half way is, is not known
};

/// Mean levels of the first and the last fifth of a profile.
struct Sides {
  double low{0}, high{0};
  std::size_t samples{0};

  explicit Sides(const std::vector<double>& profile) : samples{std::max<std::size_t>(2, profile.size() / 5)} {
    for (std::size_t i = 0; i < samples; ++i) {
      low += profile[i] / static_cast<double>(samples);
      high += profile[profile.size() - 1 - i] / static_cast<double>(samples);
    }
  }
};

/// Place [samples] and slope [per sample] of the half-way crossing in a rising profile; nothing when it does
/// not rise clearly once.
struct Crossing {
  double place;
  double slope;
};
std::optional<Crossing> half_way(const std::vector<double>& profile, const Sides& sides) {
  const double low = sides.low, high = sides.high, step = high - low;
  if (step < k_least_step_grey) return std::nullopt;
  const double half = (low + high) / 2;
  std::optional<std::size_t> crossing;
  for (std::size_t i = 0; i + 1 < profile.size(); ++i) {
    if (!(profile[i] < half && profile[i + 1] >= half)) continue;
    if (crossing) return std::nullopt;  // two steps: speckle, text, another edge
    crossing = i;
  }
  if (!crossing) return std::nullopt;
  // A straight line through the samples between a quarter and three quarters uses them all against the noise.
  std::size_t from = *crossing, to = *crossing + 1;
  while (from > 0 && profile[from - 1] > low + 0.25 * step && profile[from - 1] <= profile[from]) --from;
  while (to + 1 < profile.size() && profile[to + 1] < high - 0.25 * step && profile[to + 1] >= profile[to])
    ++to;
  double count = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (std::size_t i = from; i <= to; ++i) {
    const double x = static_cast<double>(i), y = profile[i];
    count += 1;
    sx += x;
    sy += y;
    sxx += x * x;
    sxy += x * y;
  }
  const double slope = (count * sxy - sx * sy) / (count * sxx - sx * sx);
  if (!(slope > 0)) return std::nullopt;
  return Crossing{.place = (half - (sy - slope * sx) / count) / slope, .slope = slope};
}

/// Slope over the picture, grey per pixel, of one side's level, read `beyond_px` beyond the ellipse.
Vec2 gradient_of(const std::vector<Step>& steps, double Step::*level, double beyond_px) {
  Mat3 normal = Mat3::Zero();
  Vec3 right = Vec3::Zero();
  for (const Step& step : steps) {
    const Vec2 place = step.on_px - steps.front().on_px + beyond_px * step.towards_bright;
    const Vec3 row(1, place.x(), place.y());
    normal += row * row.transpose();
    right += row * (step.*level);
  }
  return geometry::solve_symmetric(normal, right).bottomRows<2>();
}

}  // namespace

std::vector<Vec2> edge_points(const image::GreyImage& picture, const Ellipse& ellipse, EdgeSearch search) {
  const double circumference_px = std::numbers::pi * (ellipse.major_semi + ellipse.minor_semi);
  const int places = std::clamp(static_cast<int>(circumference_px), 72, 720);
  const int half_count = std::max(3, static_cast<int>(std::lround(search.reach_px / k_sample_step_px)));
  std::vector<double> profile(static_cast<std::size_t>(2 * half_count + 1));
  std::vector<Step> steps;
  steps.reserve(static_cast<std::size_t>(places));
  double side_px = 0;  ///< from the crossing to the middle of either side's samples
  for (int i = 0; i < places; ++i) {
    const double phase_rad = 2 * std::numbers::pi * i / places;
    const Vec2 on = ellipse.at(phase_rad);
    const Vec2 towards_bright =
        search.dark_outside ? Vec2(-ellipse.normal_at(phase_rad)) : ellipse.normal_at(phase_rad);
    bool inside = true;
    for (int k = -half_count; k <= half_count && inside; ++k) {
      const Vec2 place = on + towards_bright * (k * k_sample_step_px);
      inside = place.x() >= 0 && place.y() >= 0 && place.x() < picture.width_px - 1 &&
               place.y() < picture.height_px - 1;
      if (inside) profile[static_cast<std::size_t>(k + half_count)] = level_at(picture, place.x(), place.y());
    }
    if (!inside) continue;
    const Sides sides(profile);
    side_px = (half_count - (static_cast<double>(sides.samples) - 1) / 2) * k_sample_step_px;
    if (const std::optional<Crossing> crossing = half_way(profile, sides)) {
      steps.push_back({.on_px = on,
                       .towards_bright = towards_bright,
                       .place_px = (crossing->place - half_count) * k_sample_step_px,
                       .slope_per_px = crossing->slope / k_sample_step_px,
                       .low = sides.low,
                       .high = sides.high,
                       .cut = sides.high >= k_cut_grey || profile.back() >= k_cut_grey});
    }
  }
  const auto uncut = std::partition(steps.begin(), steps.end(), [](const Step& step) { return !step.cut; });
  if (static_cast<double>(uncut - steps.begin()) >= k_least_uncut_ratio * places)
    steps.erase(uncut, steps.end());
  if (steps.size() < 6) return {};
  // In light that falls off, each side is read where it is another than on the edge; what the one has too
  // much the other has too little only where both fall off alike.  On the edge itself a blur of deviation s
  // mixes in both sides from s / sqrt(2 pi) away, and the slope there is the step / (s sqrt(2 pi)).
  const Vec2 slopes_apart =
      gradient_of(steps, &Step::low, -side_px) - gradient_of(steps, &Step::high, side_px);
  std::vector<Vec2> points;
  points.reserve(steps.size());
  for (const Step& step : steps) {
    const double mixed_px = (step.high - step.low) / step.slope_per_px / std::numbers::pi;
    const double half_shift = slopes_apart.dot(step.towards_bright) * (side_px - mixed_px) / 2;
    points.push_back(step.on_px + step.towards_bright * (step.place_px + half_shift / step.slope_per_px));
  }
  return points;
}

}  // namespace biteline::calibration
