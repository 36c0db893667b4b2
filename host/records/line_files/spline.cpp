// SPDX-License-Identifier: MIT
#include "host/records/line_files/spline.hpp"

#include "common/core/contracts.hpp"

namespace biteline::line_files {

ClosedSpline spline_through(const cloud::ClosedLine& line) {
  constexpr double k_apart_mm = 1e-6;
  std::vector<Vec3> points;
  for (const cloud::LinePoint& p : line.points) {
    if (points.empty() || (p.position - points.back()).norm() > k_apart_mm) points.push_back(p.position);
  }
  while (points.size() > 1 && (points.back() - points.front()).norm() <= k_apart_mm) points.pop_back();
  BITELINE_EXPECTS(points.size() >= 3);

  const std::size_t n = points.size();
  const auto chord = [&](std::size_t i) -> Vec3 { return points[(i + 1) % n] - points[i % n]; };
  std::vector<Vec3> slope(n);  // d position / d chord length
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3 before = chord(i + n - 1), after = chord(i);
    const double h0 = before.norm(), h1 = after.norm();
    slope[i] = (before * (h1 / h0) + after * (h0 / h1)) / (h0 + h1);
  }
  ClosedSpline spline{.control = {points[0]}, .knots = {0}};
  for (std::size_t i = 0; i < n; ++i) {
    const double third = chord(i).norm() / 3;
    const Vec3& end = points[(i + 1) % n];
    spline.control.insert(spline.control.end(),
                          {points[i] + third * slope[i], end - third * slope[(i + 1) % n], end});
    spline.knots.push_back(spline.knots.back() + 3 * third);
  }
  return spline;
}

}  // namespace biteline::line_files
