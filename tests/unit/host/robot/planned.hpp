// SPDX-License-Identifier: MIT
#pragma once
/// \file A checked path for tests: the made oval under a UR5e.

#include <algorithm>
#include <map>
#include <string>

#include "host/trajectory/checks/way_there.hpp"
#include "host/trajectory/plan.hpp"
#include "tests/unit/host/trajectory/made_line.hpp"

namespace biteline::robot::test {

/// `process` is the file's name, e.g. "grind.yaml".
inline trajectory::PlanRequest plan_request(const std::string& process) {
  return {.line = trajectory::test::made_line(),
          .process = *trajectory::read_process(std::filesystem::path{BITELINE_PROCESSES} / process),
          .arm = *kinematics::arm_model("UR5e"),
          .T_line_base = SE3::Identity(),
          .table_z_mm = 40,
          .shoe = {},
          .cloud = {}};
}

/// Planned once per executable.
inline const trajectory::PlanOutcome& planned(const std::string& process) {
  static std::map<std::string, trajectory::PlanOutcome> outcomes;
  const auto known = outcomes.find(process);
  if (known != outcomes.end()) return known->second;
  return outcomes.emplace(process, trajectory::plan(plan_request(process))).first->second;
}

inline const trajectory::CheckedPath& planned_path(const std::string& process) { return *planned(process).path; }

/// An arm that stands at the line opposite the path's beginning, and the way there from it: over raised postures.
struct FromBehind {
  kinematics::Joints from_rad;
  trajectory::WayThere way;
};

inline FromBehind from_behind(const std::string& process) {
  const trajectory::PlanRequest request = plan_request(process);
  const trajectory::PlanOutcome& outcome = planned(process);
  const auto& waypoints = outcome.path->path().waypoints;
  const Vec3 begin = waypoints.front().T_base_tcp.translation();
  const auto away_mm = [&](const trajectory::Waypoint& w) { return (w.T_base_tcp.translation() - begin).norm(); };
  const auto opposite =
      std::ranges::max_element(waypoints, {}, [&](const trajectory::Waypoint& w) { return w.segment == trajectory::Segment::Line ? away_mm(w) : 0; });
  const trajectory::CollisionModel collisions{request.arm, request.process.tool, outcome.surroundings};
  return {.from_rad = opposite->q_rad, .way = trajectory::find_way_there(opposite->q_rad, *outcome.path, request.arm, collisions)};
}

}  // namespace biteline::robot::test
