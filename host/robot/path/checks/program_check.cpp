// SPDX-License-Identifier: MIT
#include "host/robot/path/checks/program_check.hpp"

#include <algorithm>
#include <cmath>

#include "host/robot/path/targets.hpp"

namespace biteline::path {
namespace {

/// The least radius that is left of the wished one where the tool must not stop.
Check blend_check(const PlannedPath& path) {
  const std::vector<double> radii_mm = blend_radii_mm(line_tips(path), path.motion.blend_mm);
  Check check{.name = "blends apart",
              .passed = false,
              .value = path.motion.blend_mm,
              .limit = k_least_blend_mm,
              .unit = "mm",
              .arc_mm = -1,
              .detail = {}};
  std::size_t on_line = 0;
  for (const Waypoint& w : path.waypoints) {
    if (w.segment != Segment::Line) continue;
    const std::size_t i = on_line++;
    if (i == 0 || i + 1 >= radii_mm.size() || radii_mm[i] >= check.value) continue;
    check.value = radii_mm[i];
    check.arc_mm = w.arc_mm;
  }
  check.passed = check.value >= check.limit;
  if (!check.passed) check.detail = "targets stand too near to each other for the controller's least blend";
  return check;
}

Check size_check(const PlannedPath& path) {
  Check check{.name = "program size",
              .passed = false,
              .value = static_cast<double>(path.waypoints.size() + path.via_rad.size()),
              .limit = static_cast<double>(k_most_targets),
              .unit = "targets",
              .arc_mm = -1,
              .detail = {}};
  check.passed = check.value <= check.limit;
  if (!check.passed) check.detail = "controllers do not start programs that long";
  return check;
}

Check rest_check(const PlannedPath& path) {
  Check check{.name = "rest at the ends",
              .passed = false,
              .value = 0,
              .limit = 0,
              .unit = "mm/s",
              .arc_mm = -1,
              .detail = {}};
  const auto& w = path.waypoints;
  const auto look = [&](const Waypoint& waypoint) {
    if (waypoint.speed_mm_s <= check.value) return;
    check.value = waypoint.speed_mm_s;
    check.arc_mm = waypoint.arc_mm;
  };
  look(w.front());
  look(w.back());
  // Where the tool's output is switched, too.
  for (std::size_t i = 0; i < w.size(); ++i) {
    if (w[i].segment != Segment::Line) continue;
    if (i == 0 || w[i - 1].segment != Segment::Line || i + 1 == w.size() || w[i + 1].segment != Segment::Line)
      look(w[i]);
  }
  check.passed = check.value <= check.limit;
  if (!check.passed) check.detail = "the path begins or ends in motion";
  return check;
}

}  // namespace

std::vector<Vec3> line_tips(const PlannedPath& path) {
  std::vector<Vec3> tips;
  for (const Waypoint& w : path.waypoints) {
    if (w.segment == Segment::Line) tips.push_back(w.T_base_tcp.translation());
  }
  return tips;
}

std::vector<Check> program_checks(const PlannedPath& path) {
  return {blend_check(path), size_check(path), rest_check(path)};
}

}  // namespace biteline::path
