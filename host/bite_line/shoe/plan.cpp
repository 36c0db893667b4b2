// SPDX-License-Identifier: MIT
#include "host/bite_line/shoe/plan.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace biteline::bite_line {

namespace {

double cross(const Vec2& a, const Vec2& b) {
  return a.x() * b.y() - a.y() * b.x();
}

/// `count` points evenly spaced along a closed curve; returns its length.
double respace(std::vector<Vec2>& curve, std::size_t count) {
  std::vector<double> at(curve.size() + 1, 0.0);
  for (std::size_t i = 0; i < curve.size(); ++i)
    at[i + 1] = at[i] + (curve[(i + 1) % curve.size()] - curve[i]).norm();
  const double length = at.back();
  std::vector<Vec2> even(count);
  std::size_t edge = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const double target = length * static_cast<double>(k) / static_cast<double>(count);
    while (edge + 1 < curve.size() && at[edge + 1] <= target) ++edge;
    const double span = std::max(at[edge + 1] - at[edge], 1e-12);
    even[k] = curve[edge] + (target - at[edge]) / span * (curve[(edge + 1) % curve.size()] - curve[edge]);
  }
  curve = std::move(even);
  return length;
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

std::vector<double> smooth_closed(std::span<const double> values, double sigma_samples) {
  const auto count = static_cast<std::ptrdiff_t>(values.size());
  const auto reach = static_cast<std::ptrdiff_t>(std::ceil(3.5 * sigma_samples));
  std::vector<double> kernel;
  double sum = 0;
  for (std::ptrdiff_t j = -reach; j <= reach; ++j) {
    kernel.push_back(std::exp(-0.5 * std::pow(static_cast<double>(j) / std::max(sigma_samples, 1e-9), 2)));
    sum += kernel.back();
  }
  std::vector<double> smooth(values.size(), 0.0);
  if (values.empty()) return smooth;
  std::vector<double> round(values.size() + 2 * static_cast<std::size_t>(reach));
  for (std::ptrdiff_t i = 0; i < count + 2 * reach; ++i)
    round[static_cast<std::size_t>(i)] =
        values[static_cast<std::size_t>(((i - reach) % count + count) % count)];
  for (std::size_t j = 0; j < kernel.size(); ++j) {
    const double share = kernel[j] / sum;
    for (std::size_t i = 0; i < smooth.size(); ++i) smooth[i] += share * round[i + j];
  }
  return smooth;
}

Outline::Outline(std::span<const Vec2> curve, const Config& config) {
  points_.assign(curve.begin(), curve.end());
  double length = 0;
  for (std::size_t i = 0; i < points_.size(); ++i)
    length += (points_[(i + 1) % points_.size()] - points_[i]).norm();
  const auto count =
      static_cast<std::size_t>(std::clamp(std::round(length / config.spacing_mm), 16.0, 30000.0));
  respace(points_, count);
  if (config.smoothing_mm > 0) {
    std::vector<double> x(count);
    std::vector<double> y(count);
    for (std::size_t i = 0; i < count; ++i) {
      x[i] = points_[i].x();
      y[i] = points_[i].y();
    }
    const double sigma = config.smoothing_mm * static_cast<double>(count) / length;
    x = smooth_closed(x, sigma);
    y = smooth_closed(y, sigma);
    for (std::size_t i = 0; i < count; ++i) points_[i] = {x[i], y[i]};
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
  bend_per_mm_ = smooth_closed(bend, 2.0);
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
  double at = std::fmod(s_mm / length_mm_ * count, count);
  if (at < 0) at += count;
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

double Outline::bend_per_mm(double s_mm) const {
  const Between b = between(s_mm);
  return (1 - b.fraction) * bend_per_mm_[b.first] + b.fraction * bend_per_mm_[b.second];
}

}  // namespace biteline::bite_line
