// SPDX-License-Identifier: MIT
#pragma once
/// \file How far a place is from a closed line of straight edges.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "host/cloud/closed_line.hpp"

namespace biteline::test {

struct NearestOnLine {
  double distance_mm{0};
  std::size_t edge{0};  ///< from this point of the line to the next one
};

/// `position_of(i)`: of the i-th of `count` points, at least one.
template <class PositionOf>
[[nodiscard]] NearestOnLine nearest_on(std::size_t count, PositionOf&& position_of, const Vec3& place) {
  NearestOnLine nearest;
  double least_mm2 = std::numeric_limits<double>::max();
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3& a = position_of(i);
    const Vec3 edge = position_of((i + 1) % count) - a;
    const double along = std::clamp((place - a).dot(edge) / std::max(edge.squaredNorm(), 1e-12), 0.0, 1.0);
    const double away_mm2 = (place - a - along * edge).squaredNorm();
    if (!(away_mm2 < least_mm2)) continue;
    least_mm2 = away_mm2;
    nearest.edge = i;
  }
  nearest.distance_mm = std::sqrt(least_mm2);
  return nearest;
}

[[nodiscard]] inline NearestOnLine nearest_on(const cloud::ClosedLine& line, const Vec3& place) {
  return nearest_on(
      line.points.size(), [&](std::size_t i) -> const Vec3& { return line.points[i].position; }, place);
}

[[nodiscard]] inline double distance_mm(const Vec3& place, const cloud::ClosedLine& line) {
  return nearest_on(line, place).distance_mm;
}

[[nodiscard]] inline double distance_mm(const Vec3& place, const std::vector<Vec3>& line) {
  return nearest_on(
             line.size(), [&](std::size_t i) -> const Vec3& { return line[i]; }, place)
      .distance_mm;
}

}  // namespace biteline::test
