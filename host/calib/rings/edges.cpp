// SPDX-License-Identifier: MIT
#include "host/calib/rings/edges.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

namespace biteline::calib {

namespace {

/// A step of less is no edge of a ring (dark print on bright paper, any sensible exposure).
constexpr double k_least_step_grey = 12;
constexpr double k_sample_step_px = 0.25;

/// Bilinear.  Pre: 0 <= u < width - 1, 0 <= v < height - 1.
double level_at(const image::GreyImage& picture, double u_px, double v_px) {
  const int u = static_cast<int>(u_px), v = static_cast<int>(v_px);
  const double fu = u_px - u, fv = v_px - v;
  const std::uint8_t* p =
      picture.pixels.data() + static_cast<std::size_t>(v) * static_cast<std::size_t>(picture.width_px) + u;
  const std::uint8_t* q = p + picture.width_px;
  return (1 - fv) * ((1 - fu) * p[0] + fu * p[1]) + fv * ((1 - fu) * q[0] + fu * q[1]);
}

/// Place of the half-way crossing in a rising profile, in samples; nothing when it does not rise clearly
/// once.
std::optional<double> half_way(const std::vector<double>& profile) {
  const std::size_t n = profile.size(), end = std::max<std::size_t>(2, n / 5);
  double low = 0, high = 0;
  for (std::size_t i = 0; i < end; ++i) {
    low += profile[i];
    high += profile[n - 1 - i];
  }
  low /= static_cast<double>(end);
  high /= static_cast<double>(end);
  const double step = high - low;
  if (step < k_least_step_grey) return std::nullopt;
  const double half = (low + high) / 2;
  std::optional<std::size_t> crossing;
  for (std::size_t i = 0; i + 1 < n; ++i) {
    if (!(profile[i] < half && profile[i + 1] >= half)) continue;
    if (crossing) return std::nullopt;  // two steps: speckle, text, another edge
    crossing = i;
  }
  if (!crossing) return std::nullopt;
  // A straight line through the samples between a quarter and three quarters uses them all against the noise.
  std::size_t from = *crossing, to = *crossing + 1;
  while (from > 0 && profile[from - 1] > low + 0.25 * step && profile[from - 1] <= profile[from]) --from;
  while (to + 1 < n && profile[to + 1] < high - 0.25 * step && profile[to + 1] >= profile[to]) ++to;
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
  return (half - (sy - slope * sx) / count) / slope;
}

}  // namespace

std::vector<Vec2> edge_points(const image::GreyImage& picture, const Ellipse& ellipse, EdgeSearch search) {
  const double circumference_px = std::numbers::pi * (ellipse.major_semi + ellipse.minor_semi);
  const int places = std::clamp(static_cast<int>(circumference_px), 72, 720);
  const int half_count = std::max(3, static_cast<int>(std::lround(search.reach_px / k_sample_step_px)));
  std::vector<double> profile(static_cast<std::size_t>(2 * half_count + 1));
  std::vector<Vec2> points;
  points.reserve(static_cast<std::size_t>(places));
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
    if (const std::optional<double> crossing = half_way(profile)) {
      points.push_back(on + towards_bright * ((*crossing - half_count) * k_sample_step_px));
    }
  }
  return points;
}

}  // namespace biteline::calib
