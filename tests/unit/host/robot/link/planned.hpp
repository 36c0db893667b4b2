// SPDX-License-Identifier: MIT
#pragma once
/// \file A checked path for tests: the made oval under a UR5e.

#include <algorithm>
#include <map>
#include <string>

#include "host/robot/path/checks/way_there.hpp"
#include "host/robot/path/plan.hpp"
#include "tests/unit/host/robot/path/made_line.hpp"

namespace biteline::robot::test {

/// `process` is the file's name, e.g. "grind.yaml".
inline path::PlanRequest plan_request(const std::string& process) {
  return {.line = path::test::made_line(),
          .process = *path::read_process(std::filesystem::path{BITELINE_PROCESSES} / process),
          .arm = *kinematics::arm_model("UR5e"),
          .T_line_base = SE3::Identity(),
          .table_z_mm = 40,
          .shoe = {},
          .cloud = {}};
}

/// Planned once per executable.
inline const path::PlanOutcome& planned(const std::string& process) {
  static std::map<std::string, path::PlanOutcome> outcomes;
  const auto known = outcomes.find(process);
  if (known != outcomes.end()) return known->second;
  return outcomes.emplace(process, path::plan(plan_request(process))).first->second;
}

inline const path::CheckedPath& planned_path(const std::string& process) {
  return *planned(process).path;
}

/// An arm that stands at the line opposite the path's beginning, and the way there from it: over raised
/// postures.
struct FromBehind {
  kinematics::Joints from_rad;
  path::WayThere way;
};

inline FromBehind from_behind(const std::string& process) {
  const path::PlanRequest request = plan_request(process);
  const path::PlanOutcome& outcome = planned(process);
  const auto& waypoints = outcome.path->path().waypoints;
  const Vec3 begin = waypoints.front().T_base_tcp.translation();
  const auto away_mm = [&](const path::Waypoint& w) { return (w.T_base_tcp.translation() - begin).norm(); };
  const auto opposite = std::ranges::max_element(waypoints, {}, [&](const path::Waypoint& w) {
    return w.segment == path::Segment::Line ? away_mm(w) : 0;
  });
  const path::CollisionModel collisions{request.arm, request.process.tool, outcome.surroundings};
  return {.from_rad = opposite->q_rad,
          .way = path::find_way_there(opposite->q_rad, *outcome.path, request.arm, collisions)};
}

}  // namespace biteline::robot::test
