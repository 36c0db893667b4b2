// SPDX-License-Identifier: MIT
#include "host/robot/path/checks/line_check.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "common/core/numbers.hpp"
#include "host/cloud/flagged.hpp"
#include "host/geometry/robust.hpp"

namespace biteline::path {
namespace {

using cloud::ClosedLine;

// A shoe's line is 400 to 800 mm long; below 100 mm no shoe, and curvature and spacing lose their meaning.
constexpr double k_min_length_mm = 100;
// The line format promises even spacing; a step of twice the median is a hole that a tool would cut across.
constexpr double k_max_step_ratio = 2.0;
constexpr double k_max_step_mm = 10;
// A metre at 0.05 mm; every pair of them is compared.
constexpr std::size_t k_most_points = 20'000;
// A normal's part outwards: a wall that leans by 78 degrees is no upper's at its sole.
constexpr double k_least_outward = 0.2;
// The file's own tangent may be off by its noise, not by 60 degrees.
constexpr double k_least_along = 0.5;

std::vector<double> steps_mm(const ClosedLine& line) {
  std::vector<double> steps(line.points.size());
  for (std::size_t i = 0; i < steps.size(); ++i) {
    steps[i] = (line.points[(i + 1) % steps.size()].position - line.points[i].position).norm();
  }
  return steps;
}

/// Direction of the line at a point, from the places some millimetres to either side: the file's own is not
/// asked.
Vec3 direction_at(const ClosedLine& line, const std::vector<double>& steps, std::size_t i) {
  constexpr double k_to_either_side_mm = 3;
  const std::size_t n = line.points.size();
  std::size_t before = i, after = i, taken = 0;
  // Not over a hole, which has its own check.
  for (double mm = 0; mm < k_to_either_side_mm && taken + 2 < n && steps[after] <= k_max_step_mm; ++taken) {
    mm += steps[after];
    after = (after + 1) % n;
  }
  for (double mm = 0; mm < k_to_either_side_mm && taken + 2 < n; ++taken) {
    const std::size_t next = (before + n - 1) % n;
    if (!(steps[next] <= k_max_step_mm)) break;
    mm += steps[next];
    before = next;
  }
  const Vec3 along = line.points[after].position - line.points[before].position;
  const double length_mm = along.norm();
  return length_mm > 0 ? Vec3(along / length_mm) : Vec3(Vec3::Zero());
}

/// A line that is none: what is asked further is not asked of it.
std::optional<Check> plausible_check(const ClosedLine& line) {
  const std::size_t n = line.points.size();
  Check check{.name = "points",
              .passed = false,
              .value = static_cast<double>(n),
              .limit = static_cast<double>(k_most_points),
              .unit = "points",
              .arc_mm = -1,
              .detail = "a line of some hundred to some thousand points expected"};
  if (n < 3 || n > k_most_points) return check;
  const auto good = [](const cloud::LinePoint& p) {
    return is_plausible_place(p.position) && p.normal.cwiseAbs().maxCoeff() < 2 && p.normal.allFinite();
  };
  check.value = static_cast<double>(std::ranges::count_if(line.points, good));
  if (check.value == static_cast<double>(n)) return std::nullopt;
  check.limit = static_cast<double>(n);
  check.detail = "places and normals that are no numbers, or farther than 100 m";
  return check;
}

/// What a person has not settled is no way for a tool.
Check settled_check(const ClosedLine& line) {
  const double percent = 100 * cloud::flagged_share(line);
  return {.name = "settled",
          .passed = percent <= 100 * cloud::k_most_flagged_share,
          .value = percent,
          .limit = 100 * cloud::k_most_flagged_share,
          .unit = "%",
          .arc_mm = -1,
          .detail = "so much of the line is flagged: a person must settle its flagged stretches first"};
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
  if (const std::optional<Check> failed = plausible_check(line)) return {*failed};
  const std::vector<double> steps = steps_mm(line);
  const double middle_mm = geometry::median_of(steps);
  const auto add = [&](Check check) {
    if (check.passed) check.detail.clear();
    checks.push_back(std::move(check));
  };

  double length_mm = 0, worst_mm = 0, worst_arc_mm = 0;
  for (std::size_t i = 0; i + 1 < steps.size(); ++i) {
    if (!(steps[i] <= worst_mm)) {
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
  add(settled_check(line));
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
  int inward = 0, astray = 0;
  for (std::size_t i = 0; i < line.points.size(); ++i) {
    const cloud::LinePoint& p = line.points[i];
    area_mm2 += 0.5 * cross2(p.position, line.points[(i + 1) % line.points.size()].position);
    const Vec3 direction = direction_at(line, steps, i);
    worst_square = std::max(worst_square, std::abs(p.normal.dot(direction)));
    // Outward of an anticlockwise line is to its right, tangent x up.
    const Vec3 outward = direction.cross(Vec3::UnitZ());
    if (!(p.normal.dot(outward) >= k_least_outward * outward.norm()) || !(outward.norm() > 0)) ++inward;
    if (!(p.tangent.dot(direction) >= k_least_along)) ++astray;
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
       .detail = "normals point into the shoe, or up and not out of it"});
  add({.name = "tangents along the line",
       .passed = astray == 0,
       .value = static_cast<double>(astray),
       .limit = 0,
       .unit = "points",
       .arc_mm = -1,
       .detail = "tangents do not follow the places"});
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
