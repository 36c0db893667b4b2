// SPDX-License-Identifier: MIT
#include "host/robot/path/checks/line_check.hpp"

#include <algorithm>
#include <cmath>

namespace biteline::path {
namespace {

using cloud::ClosedLine;

// A shoe's line is 400 to 800 mm long; below 100 mm no shoe, and curvature and spacing lose their meaning.
constexpr double k_min_length_mm = 100;
// The line format promises even spacing; a step of twice the median is a hole that a tool would cut across.
constexpr double k_max_step_ratio = 2.0;
constexpr double k_max_step_mm = 10;

std::vector<double> steps_mm(const ClosedLine& line) {
  std::vector<double> steps(line.points.size());
  for (std::size_t i = 0; i < steps.size(); ++i) {
    steps[i] = (line.points[(i + 1) % steps.size()].position - line.points[i].position).norm();
  }
  return steps;
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2),
                   values.end());
  return values[values.size() / 2];
}

double cross2(const Vec3& a, const Vec3& b) {
  return a.x() * b.y() - a.y() * b.x();
}

/// Whether the segments cross, seen from above.
bool cross(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const double side_a = cross2(d - c, a - c), side_b = cross2(d - c, b - c);
  const double side_c = cross2(b - a, c - a), side_d = cross2(b - a, d - a);
  return side_a * side_b < 0 && side_c * side_d < 0;
}

Check crossing_check(const ClosedLine& line, const std::vector<double>& steps) {
  // Every pair once with a test on boxes first; a line has some thousand points at most.
  Check check{.name = "no self-crossing",
              .passed = true,
              .value = 0,
              .limit = 0,
              .unit = "crossings",
              .arc_mm = -1,
              .detail = {}};
  const std::size_t n = line.points.size();
  double arc_mm = 0;
  for (std::size_t i = 0; i < n; arc_mm += steps[i], ++i) {
    const Vec3& a = line.points[i].position;
    const Vec3& b = line.points[(i + 1) % n].position;
    const double x_low = std::min(a.x(), b.x()), x_high = std::max(a.x(), b.x());
    for (std::size_t k = i + 2; k < n; ++k) {
      if (i == 0 && k == n - 1) continue;
      const Vec3& c = line.points[k].position;
      const Vec3& d = line.points[(k + 1) % n].position;
      if (std::max(c.x(), d.x()) < x_low || std::min(c.x(), d.x()) > x_high) continue;
      if (!cross(a, b, c, d)) continue;
      if (check.passed) check.arc_mm = arc_mm;
      check.passed = false;
      check.value += 1;
    }
  }
  if (!check.passed) check.detail = "the line crosses itself seen from above";
  return check;
}

}  // namespace

bool all_passed(const std::vector<Check>& checks) {
  return std::ranges::all_of(checks, [](const Check& check) { return check.passed; });
}

std::vector<Check> check_line(const ClosedLine& line) {
  std::vector<Check> checks;
  const std::vector<double> steps = steps_mm(line);
  const double middle_mm = median(steps);
  const auto add = [&](Check check) {
    if (check.passed) check.detail.clear();
    checks.push_back(std::move(check));
  };

  double length_mm = 0, worst_mm = 0, worst_arc_mm = 0;
  for (std::size_t i = 0; i + 1 < steps.size(); ++i) {
    if (steps[i] > worst_mm) {
      worst_mm = steps[i];
      worst_arc_mm = length_mm;
    }
    length_mm += steps[i];
  }
  const double limit_mm = std::min(k_max_step_mm, k_max_step_ratio * std::max(middle_mm, 0.05));
  add({.name = "closed",
       .passed = steps.back() <= limit_mm,
       .value = steps.back(),
       .limit = limit_mm,
       .unit = "mm",
       .arc_mm = length_mm,
       .detail = "the last point is too far from the first: the line is open"});
  length_mm += steps.back();
  add({.name = "length",
       .passed = length_mm >= k_min_length_mm,
       .value = length_mm,
       .limit = k_min_length_mm,
       .unit = "mm",
       .arc_mm = -1,
       .detail = "too short for a shoe"});
  add({.name = "spacing",
       .passed = worst_mm <= limit_mm,
       .value = worst_mm,
       .limit = limit_mm,
       .unit = "mm",
       .arc_mm = worst_arc_mm,
       .detail = "neighbouring points are too far apart: the line has a hole"});
  add(crossing_check(line, steps));

  double area_mm2 = 0, worst_square = 0;
  int inward = 0;
  for (std::size_t i = 0; i < line.points.size(); ++i) {
    const cloud::LinePoint& p = line.points[i];
    area_mm2 += 0.5 * cross2(p.position, line.points[(i + 1) % line.points.size()].position);
    worst_square = std::max(worst_square, std::abs(p.normal.dot(p.tangent)));
    // Outward of an anticlockwise line is to its right, tangent x up.
    if (p.normal.dot(p.tangent.cross(Vec3::UnitZ())) < 0) ++inward;
  }
  add({.name = "anticlockwise",
       .passed = area_mm2 > 0,
       .value = area_mm2,
       .limit = 0,
       .unit = "mm^2",
       .arc_mm = -1,
       .detail = "the line runs clockwise seen from above"});
  add({.name = "normals outward",
       .passed = inward == 0,
       .value = static_cast<double>(inward),
       .limit = 0,
       .unit = "points",
       .arc_mm = -1,
       .detail = "normals point into the shoe"});
  // 0.5: 30 degrees off a right angle; normals of a good line are within 10.
  add({.name = "normals across the line",
       .passed = worst_square <= 0.5,
       .value = worst_square,
       .limit = 0.5,
       .unit = "cosine",
       .arc_mm = -1,
       .detail = "a normal points along the line"});
  return checks;
}

}  // namespace biteline::path
