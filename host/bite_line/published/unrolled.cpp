// SPDX-License-Identifier: MIT
#include "host/bite_line/published/unrolled.hpp"

#include <algorithm>
#include <cmath>

namespace biteline::published {

namespace {

double cross(const Vec2& a, const Vec2& b) {
  return a.x() * b.y() - a.y() * b.x();
}

/// Where the ray from `from` through `to` meets the segment a b, as a share of it; clamped to the segment.
double meet(const Vec2& from, const Vec2& to, const Vec2& a, const Vec2& b) {
  const Vec2 ray = to - from;
  const Vec2 side = b - a;
  const double det = cross(side, ray);
  if (std::abs(det) < 1e-9) return 0.5;
  return std::clamp(cross(from - a, ray) / det, 0.0, 1.0);
}

}  // namespace

EightSections::EightSections(const Config& config)
    : low_x_mm_{config.end_ratio * config.length_mm}, high_x_mm_{(1 - config.end_ratio) * config.length_mm} {
  const double w = config.half_width_mm;
  const double l = config.length_mm;
  corner_ = {Vec2{high_x_mm_, w}, Vec2{low_x_mm_, w},  Vec2{0, 0.5 * w},
             Vec2{0, -0.5 * w},   Vec2{low_x_mm_, -w}, Vec2{high_x_mm_, -w},
             Vec2{l, -0.5 * w},   Vec2{l, 0.5 * w},    Vec2{high_x_mm_, w}};
  for (std::size_t i = 0; i < 8; ++i) start_mm_[i + 1] = start_mm_[i] + (corner_[i + 1] - corner_[i]).norm();
}

double EightSections::along_mm(double x_mm, double y_mm) const {
  if (x_mm >= low_x_mm_ && x_mm <= high_x_mm_) {
    return y_mm >= 0 ? start_mm_[0] + (high_x_mm_ - x_mm) : start_mm_[4] + (x_mm - low_x_mm_);
  }
  const bool heel = x_mm < low_x_mm_;
  const Vec2 middle{heel ? low_x_mm_ : high_x_mm_, 0.0};
  const Vec2 point{x_mm, y_mm};
  const std::size_t first = heel ? 1 : 5;
  for (std::size_t i = first; i < first + 3; ++i) {
    const bool last = i == first + 2;
    if (last || cross(corner_[i + 1] - middle, point - middle) <= 0) {
      return start_mm_[i] +
             meet(middle, point, corner_[i], corner_[i + 1]) * (start_mm_[i + 1] - start_mm_[i]);
    }
  }
  return 0;
}

PixelPlace pixel_of(const Unrolled& picture, const EightSections& sections, const Eigen::Vector3f& point) {
  const int row =
      static_cast<int>(std::floor((picture.top_mm - static_cast<double>(point.z())) / picture.row_mm));
  if (row < 0 || row >= picture.rows) return {};
  const double along = sections.along_mm(static_cast<double>(point.x()), static_cast<double>(point.y()));
  return {row, std::clamp(static_cast<int>(along / picture.col_mm), 0, picture.cols - 1)};
}

Unrolled unroll(std::span<const Eigen::Vector3f> points, std::span<const float> feature,
                const EightSections& sections, const UnrollConfig& config) {
  Unrolled picture;
  picture.row_mm = config.row_mm;
  picture.cols = static_cast<int>(sections.perimeter_mm() / config.col_mm);
  picture.col_mm = sections.perimeter_mm() / picture.cols;
  float low = 1e9F;
  float high = -1e9F;
  for (const Eigen::Vector3f& p : points) {
    low = std::min(low, p.z());
    high = std::max(high, p.z());
  }
  if (points.empty()) low = high = 0;
  picture.top_mm = static_cast<double>(high) + 1e-3;
  picture.rows = static_cast<int>((picture.top_mm - static_cast<double>(low)) / config.row_mm) + 1;
  for (std::size_t i = 0; i < 8; ++i)
    picture.section_col[i] = static_cast<int>(sections.start_mm(i) / picture.col_mm);
  const auto pixels = static_cast<std::size_t>(picture.rows) * static_cast<std::size_t>(picture.cols);
  picture.value.assign(pixels, 0.0F);
  picture.known.assign(pixels, 0);
  std::vector<std::uint32_t> count(pixels, 0);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const PixelPlace place = pixel_of(picture, sections, points[i]);
    if (place.row < 0) continue;
    const std::size_t pixel = picture.at(place.row, place.col);
    picture.value[pixel] += feature[i];
    ++count[pixel];
    picture.known[pixel] = 1;
  }
  for (std::size_t i = 0; i < pixels; ++i) {
    if (count[i] > 0) picture.value[i] /= static_cast<float>(count[i]);
  }
  return picture;
}

}  // namespace biteline::published
