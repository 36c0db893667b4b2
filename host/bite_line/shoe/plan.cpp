// SPDX-License-Identifier: MIT
#include "host/bite_line/shoe/plan.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "host/geometry/closed_curve.hpp"

namespace biteline::bite_line {

namespace {

double cross(const Vec2& a, const Vec2& b) {
  return a.x() * b.y() - a.y() * b.x();
}

/// `count` points evenly spaced along a closed curve; returns its length.
double respace(std::vector<Vec2>& curve, std::size_t count) {
  const geometry::ArcLength along{curve.size(), [&](std::size_t i) { return curve[i]; }};
  std::vector<Vec2> even;
  even.reserve(count);
  for (const geometry::OnCurve& at : along.even(count))
    even.push_back(curve[at.before] + at.share * (curve[at.after] - curve[at.before]));
  curve = std::move(even);
  return along.total_mm();
}

/// Drops what lies within the octagon of the outermost points in eight directions: most of a cloud, and never
/// a corner of its hull (Akl and Toussaint 1978).
void drop_inner(std::vector<Vec2>& points) {
  if (points.size() < 100) return;
  std::array<Vec2, 8> corner;
  std::array<double, 8> reach;
  reach.fill(-std::numeric_limits<double>::max());
  for (const Vec2& p : points) {
    const double sum = p.x() + p.y();
    const double difference = p.x() - p.y();
    const std::array<double, 8> along{p.x(), sum, p.y(), -difference, -p.x(), -sum, -p.y(), difference};
    for (std::size_t k = 0; k < corner.size(); ++k) {
      if (along[k] <= reach[k]) continue;
      reach[k] = along[k];
      corner[k] = p;
    }
  }
  std::erase_if(points, [&](const Vec2& p) {
    for (std::size_t k = 0; k < corner.size(); ++k) {
      const Vec2& a = corner[k];
      const Vec2& b = corner[(k + 1) % corner.size()];
      if (a != b && cross(b - a, p - a) <= 0) return false;
    }
    return true;
  });
}

}  // namespace

std::vector<Vec2> convex_hull(std::vector<Vec2> points) {
  drop_inner(points);
  std::sort(points.begin(), points.end(),
            [](const Vec2& a, const Vec2& b) { return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y(); });
  if (points.size() < 3) return points;
  std::vector<Vec2> hull(2 * points.size());
  std::size_t size = 0;
  const auto add = [&](const Vec2& p, std::size_t floor) {
    while (size >= floor + 2 && cross(hull[size - 1] - hull[size - 2], p - hull[size - 2]) <= 0) --size;
    hull[size++] = p;
  };
  for (const Vec2& p : points) add(p, 0);
  const std::size_t lower = size - 1;
  for (std::size_t i = points.size() - 1; i-- > 0;) add(points[i], lower);
  hull.resize(size - 1);
  return hull;
}

PlanBox tightest_box(std::span<const Vec2> hull) {
  PlanBox best;
  double best_area = std::numeric_limits<double>::max();
  for (std::size_t i = 0; i < hull.size(); ++i) {
    const Vec2 along = (hull[(i + 1) % hull.size()] - hull[i]).normalized();
    const Vec2 across{-along.y(), along.x()};
    Vec2 low = Vec2::Constant(std::numeric_limits<double>::max());
    Vec2 high = -low;
    for (const Vec2& p : hull) {
      const Vec2 local{p.dot(along), p.dot(across)};
      low = low.cwiseMin(local);
      high = high.cwiseMax(local);
    }
    const Vec2 size = high - low;
    if (size.prod() >= best_area) continue;
    best_area = size.prod();
    const Vec2 middle = 0.5 * (low + high);
    best.centre = middle.x() * along + middle.y() * across;
    best.long_axis = size.x() >= size.y() ? along : across;
    best.length_mm = size.maxCoeff();
    best.width_mm = size.minCoeff();
  }
  double area = 0;
  Vec2 moment = Vec2::Zero();
  for (std::size_t i = 0; i < hull.size(); ++i) {
    const Vec2 a = hull[i] - best.centre;
    const Vec2 b = hull[(i + 1) % hull.size()] - best.centre;
    area += 0.5 * cross(a, b);
    moment += cross(a, b) / 6.0 * (a + b);
  }
  best.area_centroid = best.centre + moment / std::max(area, 1e-9);
  return best;
}

Outline::Outline(std::span<const Vec2> curve, const Config& config) {
  points_.assign(curve.begin(), curve.end());
  const double length = geometry::ArcLength{curve.size(), [&](std::size_t i) { return curve[i]; }}.total_mm();
  const auto count =
      static_cast<std::size_t>(std::clamp(std::round(length / config.spacing_mm), 16.0, 30000.0));
  respace(points_, count);
  if (config.smoothing_mm > 0) {
    const double sigma = config.smoothing_mm * static_cast<double>(count) / length;
    points_ = geometry::smooth_closed<Vec2>(points_, sigma, Vec2::Zero());
  }
  respace(points_, count);
  length_mm_ = respace(points_, count);

  normals_.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    const Vec2 tangent = (points_[(i + 1) % count] - points_[(i + count - 1) % count]).normalized();
    normals_[i] = {tangent.y(), -tangent.x()};
  }
  std::vector<double> bend(count);
  for (std::size_t i = 0; i < count; ++i) {
    bend[i] = cross(normals_[(i + count - 1) % count], normals_[(i + 1) % count]) / (2.0 * spacing_mm());
  }
  bend_per_mm_ = geometry::smooth_closed(bend, 2.0);
  std::vector<OutlineLookup::Sample> samples;
  samples.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector2f p = points_[i].cast<float>();
    const Eigen::Vector2f n = normals_[i].cast<float>();
    samples.push_back({p.x(), p.y(), n.x(), n.y(), static_cast<float>(bend_per_mm_[i])});
  }
  lookup_ = {std::move(samples), static_cast<float>(length_mm_), static_cast<float>(config.reach_mm)};
}

OutlinePlace Outline::locate(const Eigen::Vector3f& point) const {
  OutlinePlace place;
  locate({&point, 1}, {&place, 1});
  return place;
}

Outline::Between Outline::between(double s_mm) const {
  const auto count = static_cast<double>(points_.size());
  double at = s_mm / length_mm_ * count;
  at -= count * std::floor(at / count);
  const auto first = static_cast<std::size_t>(at) % points_.size();
  return {first, (first + 1) % points_.size(), at - std::floor(at)};
}

Vec2 Outline::point(double s_mm) const {
  const Between b = between(s_mm);
  return (1 - b.fraction) * points_[b.first] + b.fraction * points_[b.second];
}

Vec2 Outline::normal(double s_mm) const {
  const Between b = between(s_mm);
  return ((1 - b.fraction) * normals_[b.first] + b.fraction * normals_[b.second]).normalized();
}

Vec2 Outline::outwards(double s_mm, double o_mm) const {
  const Between b = between(s_mm);
  const double left = 1 - b.fraction;
  return left * points_[b.first] + b.fraction * points_[b.second] +
         o_mm * (left * normals_[b.first] + b.fraction * normals_[b.second]).normalized();
}

double Outline::bend_per_mm(double s_mm) const {
  const Between b = between(s_mm);
  return (1 - b.fraction) * bend_per_mm_[b.first] + b.fraction * bend_per_mm_[b.second];
}

}  // namespace biteline::bite_line
