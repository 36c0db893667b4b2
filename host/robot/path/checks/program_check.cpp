// SPDX-License-Identifier: MIT
#include "host/robot/path/checks/program_check.hpp"

#include <algorithm>
#include <cmath>

#include "host/robot/path/targets.hpp"

namespace biteline::path {
namespace {

/// The least radius that is left of the wished one where the tool must not stop.
Check blend_check(const PlannedPath& path) {
  Check check{.name = "blends apart",
              .passed = false,
              .value = path.motion.blend_mm,
              .limit = k_least_blend_mm,
              .unit = "mm",
              .arc_mm = -1,
              .detail = {}};
  for (const PathRun& run : rounded_runs(path)) {
    const std::vector<double> radii_mm = blend_radii_mm(tips_of(path, run), path.motion.blend_mm);
    for (std::size_t i = 1; i + 1 < radii_mm.size(); ++i) {
      if (radii_mm[i] >= check.value) continue;
      check.value = radii_mm[i];
      check.arc_mm = path.waypoints[run.first + i].arc_mm;
    }
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
  // Where the tool's output is switched, and where a way between begins and ends, too.
  for (const PathRun& run : rounded_runs(path)) {
    look(w[run.first]);
    look(w[run.last]);
  }
  check.passed = check.value <= check.limit;
  if (!check.passed) check.detail = "the path begins or ends in motion";
  return check;
}

}  // namespace

std::vector<PathRun> runs_of(const PlannedPath& path, Segment segment) {
  std::vector<PathRun> runs;
  for (std::size_t i = 0; i < path.waypoints.size(); ++i) {
    if (path.waypoints[i].segment != segment) continue;
    if (i > 0 && path.waypoints[i - 1].segment == segment) {
      runs.back().last = i;
    } else {
      runs.push_back({.first = i, .last = i});
    }
  }
  return runs;
}

std::vector<PathRun> rounded_runs(const PlannedPath& path) {
  std::vector<PathRun> runs = runs_of(path, Segment::Line);
  for (const PathRun& run : runs_of(path, Segment::Travel))
    runs.push_back({.first = run.first > 0 ? run.first - 1 : 0, .last = run.last});
  std::ranges::sort(runs, {}, &PathRun::first);
  return runs;
}

std::vector<Vec3> tips_of(const PlannedPath& path, const PathRun& run) {
  std::vector<Vec3> tips;
  for (std::size_t i = run.first; i <= run.last; ++i)
    tips.emplace_back(path.waypoints[i].T_base_tcp.translation());
  return tips;
}

std::vector<Check> program_checks(const PlannedPath& path) {
  return {blend_check(path), size_check(path), rest_check(path)};
}

}  // namespace biteline::path
