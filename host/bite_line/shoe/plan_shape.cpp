// SPDX-License-Identifier: MIT
#include "host/bite_line/shoe/plan_shape.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "host/geometry/logistic.hpp"

namespace biteline::bite_line {

namespace {

constexpr std::size_t k_slices = 200;

/// The curve in its own axes: x along which the area within reaches farthest from its middle.
std::vector<Vec2> along_itself(std::span<const Vec2> curve) {
  Eigen::Matrix2d moments = Eigen::Matrix2d::Zero();
  Vec2 first = Vec2::Zero();
  double area = 0;
  // Triangles from a point of the curve, so that numbers stay small.
  for (std::size_t i = 0; i < curve.size(); ++i) {
    const Vec2 a = curve[i] - curve[0];
    const Vec2 b = curve[(i + 1) % curve.size()] - curve[0];
    const double twice = a.x() * b.y() - a.y() * b.x();
    area += twice / 2;
    first += twice / 6 * (a + b);
    moments += twice / 24 * (a * a.transpose() + b * b.transpose() + (a + b) * (a + b).transpose());
  }
  if (std::abs(area) < 1e-6) return {curve.begin(), curve.end()};
  const Eigen::Matrix2d spread = (moments - first * first.transpose() / area) / area;
  const double angle = 0.5 * std::atan2(2 * spread(0, 1), spread(0, 0) - spread(1, 1));
  const Vec2 along{std::cos(angle), std::sin(angle)};
  std::vector<Vec2> turned;
  for (const Vec2& p : curve) turned.emplace_back(along.dot(p), along.x() * p.y() - along.y() * p.x());
  return turned;
}

/// Breadth of a closed curve in slices of its length.
std::vector<double> breadths(std::span<const Vec2> curve) {
  constexpr double k_none = std::numeric_limits<double>::infinity();
  const auto [low, high] = std::minmax_element(curve.begin(), curve.end(),
                                               [](const Vec2& a, const Vec2& b) { return a.x() < b.x(); });
  const double length = std::max(high->x() - low->x(), 1e-6);
  const auto slice_at = [heel_x = low->x(), length](double x) { return (x - heel_x) / length * k_slices; };
  std::vector<double> left(k_slices + 1, -k_none);
  std::vector<double> right(k_slices + 1, k_none);
  for (std::size_t i = 0; i < curve.size(); ++i) {
    const Vec2& a = curve[i];
    const Vec2& b = curve[(i + 1) % curve.size()];
    const double from = slice_at(std::min(a.x(), b.x()));
    const double to = slice_at(std::max(a.x(), b.x()));
    for (auto slice = static_cast<std::size_t>(std::ceil(from)); static_cast<double>(slice) <= to; ++slice) {
      const double share = (static_cast<double>(slice) - slice_at(a.x())) /
                           std::copysign(std::max(to - from, 1e-9), b.x() - a.x());
      const double y = a.y() + std::clamp(share, 0.0, 1.0) * (b.y() - a.y());
      left[slice] = std::max(left[slice], y);
      right[slice] = std::min(right[slice], y);
    }
  }
  std::vector<double> breadth;
  for (std::size_t slice = 0; slice <= k_slices; ++slice)
    breadth.push_back(std::max(left[slice] - right[slice], 0.0));
  return breadth;
}

}  // namespace

PlanShape plan_shape(std::span<const Vec2> curve) {
  if (curve.size() < 3) return {};
  std::vector<double> breadth = breadths(along_itself(curve));
  const double most = std::max(*std::max_element(breadth.begin(), breadth.end()), 1e-6);
  const auto broad = [&](double b) { return b >= 0.98 * most; };
  const auto first = std::find_if(breadth.begin(), breadth.end(), broad) - breadth.begin();
  const auto last = std::find_if(breadth.rbegin(), breadth.rend(), broad) - breadth.rbegin();
  const double broadest_at = 0.5 * (1 + static_cast<double>(first - last) / static_cast<double>(k_slices));
  // A shoe with a flared heel may have been turned round.
  if (broadest_at < 0.5) std::reverse(breadth.begin(), breadth.end());
  const auto at = [&](double share) {
    return breadth[static_cast<std::size_t>(std::lround(share * k_slices))] / most;
  };
  return {.broadest_at = std::max(broadest_at, 1 - broadest_at),
          .end_breadth = std::max(at(0.03), at(0.97)),
          .heel_breadth = at(0.10)};
}

double distance_to_shoes(const PlanShape& shape, const ShoeOutlines& shoes) {
  const std::array x{shape.broadest_at - shoes.mean[0], shape.end_breadth - shoes.mean[1],
                     shape.heel_breadth - shoes.mean[2]};
  const auto& w = shoes.whiten;
  return std::hypot(w[0] * x[0], w[1] * x[0] + w[2] * x[1], w[3] * x[0] + w[4] * x[1] + w[5] * x[2]);
}

double shoe_chance(const PlanShape& shape, const ShoeOutlines& shoes) {
  return geometry::logistic((shoes.limit - distance_to_shoes(shape, shoes)) / shoes.softness);
}

}  // namespace biteline::bite_line
