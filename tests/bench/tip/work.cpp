// SPDX-License-Identifier: MIT
#include "tests/bench/tip/work.hpp"

#include <algorithm>
#include <cmath>

#include "hal/sim/record/surroundings.hpp"
#include "hal/sim/robot/program.hpp"
#include "host/robot/link/ur/script.hpp"
#include "host/robot/path/certainty.hpp"
#include "host/robot/path/checks/program_check.hpp"
#include "host/robot/path/place.hpp"
#include "host/robot/path/plan.hpp"
#include "tests/support/line_distance.hpp"

namespace biteline::bench {
namespace {

/// The true tip's poses along the program.
std::vector<SE3> true_tips(const TipScan& scan, const sim::Program& program, const SE3& T_flange_tip,
                           const Variant& variant) {
  constexpr double k_settle_s = 0.1;
  const sim::ArmKinematics& arm = scan.cell.arm.controller(variant.reckoning);
  sim::JointVector near_rad = scan.end_rad();
  const auto q_rad_at = [&](double time_s) {
    if (const auto told_rad = program.q_rad_at(time_s)) {
      near_rad = *told_rad;
    } else if (const auto q_rad = arm.joints_near(program.T_base_flange_at(time_s), near_rad)) {
      near_rad = *q_rad;
    }
    return near_rad;
  };
  const JointRun run{dynamics_of(variant.sources), program.duration_s() + k_settle_s, q_rad_at};
  std::vector<SE3> tips;
  for (const JointRun::Row& row : run.rows())
    tips.push_back(scan.cell.arm.T_base_flange(row.q_link_rad, !variant.sources.links) * T_flange_tip);
  return tips;
}

bool on_line(const path::PlannedPath& path, const path::PathPlace& place) {
  return path.waypoints[place.segment].segment == path::Segment::Line &&
         path.waypoints[place.segment + 1].segment == path::Segment::Line;
}

/// The line's point at that place of the plan, seen from the planned tip.
Vec3 work_in_tip(const path::PlannedPath& path, const path::PathPlace& place) {
  const Vec3 &a = path.waypoints[place.segment].line_base, &b = path.waypoints[place.segment + 1].line_base;
  return path::pose_at(path, place).inverse(Eigen::Isometry) * Vec3(a + place.fraction * (b - a));
}

std::vector<double> off_line_mm(const path::PlannedPath& path, const std::vector<SE3>& tips,
                                const std::vector<Vec3>& line) {
  // The tips are on the path's beginning before they go along it; a tip is off it by some tenths.
  constexpr double k_begins_mm = 3, k_ahead_mm = 25, k_back_mm = 2, k_each_mm = 0.5;
  std::vector<double> off_mm;
  double here_mm = -1, told_mm = -1;
  for (const SE3& tip : tips) {
    if (here_mm < 0) {
      if ((tip.translation() - path.waypoints.front().T_base_tcp.translation()).norm() > k_begins_mm)
        continue;
      here_mm = 0;
    }
    const path::PathPlace place = path::nearest_place(
        path, tip.translation(), {.from_mm = here_mm - k_back_mm, .to_mm = here_mm + k_ahead_mm});
    here_mm = std::max(here_mm, path::arc_at(path, place));
    if (!on_line(path, place) || here_mm < told_mm + k_each_mm) continue;
    told_mm = here_mm;
    off_mm.push_back(test::distance_mm(tip * work_in_tip(path, place), line));
  }
  return off_mm;
}

/// Of the plan, along what is worked.
double line_s(const path::PlannedPath& path) {
  double sum_s = 0;
  for (const path::PathRun& run : path::runs_of(path, path::Segment::Line))
    sum_s += path.waypoints[run.last].time_s - path.waypoints[run.first].time_s;
  return sum_s;
}

std::vector<Vec3> true_line_base(const sim::MadeScene& scene) {
  std::vector<Vec3> line;
  for (const sim::TrueLinePoint& p : scene.line) line.push_back(scene.T_base_shoe * p.point_shoe);
  return line;
}

}  // namespace

Result<Worked> work(const TipScan& scan, const HostScan& host, const path::Process& process,
                    const Variant& variant) {
  const sim::MadeScene& scene = *scan.scene;
  BITELINE_ASSIGN(const TaughtTip tip, teach_tip(scan.cell, variant, process.tool));
  path::Process taught = process;
  taught.tool.T_flange_tcp.translation() = tip.taught_flange;
  BITELINE_ASSIGN(const kinematics::ArmModel planned_arm, scan.cell.arm.planned(variant.reckoning));
  const path::PlanOutcome planned = path::plan(
      {.line = host.found.line,
       .process = taught,
       .arm = planned_arm,
       .table_z_mm = 0,
       .fixture = path::Fixture{.top_z_mm = scene.T_base_shoe.translation().z(),
                                .beyond_mm = sim::plate_beyond_line_mm(scene.shoe.outline(), scene.line)},
       .shoe = {},
       .from_rad = scan.end_rad(),
       .cloud = host.points_base,
       .seek_remedy = false});
  if (!planned.path) return Worked{.refused = planned.reason()};
  const path::PlannedPath& path = planned.path->path();
  BITELINE_ASSIGN(sim::Script script, sim::parse_script(robot::ur::urscript(*planned.path)));
  script.start_rad = scan.end_rad();
  const sim::ArmKinematics& controller = scan.cell.arm.controller(variant.reckoning);
  const sim::Program program =
      sim::Program::plan(script, controller, controller.T_base_flange(*script.start_rad), SE3::Identity());
  SE3 T_flange_tip = taught.tool.T_flange_tcp;
  T_flange_tip.translation() = tip.true_flange;
  const path::Certainty certainty = path::certainty_of(path, process.gate.tolerance_mm);
  return Worked{
      .off_mm = off_line_mm(path, true_tips(scan, program, T_flange_tip, variant), true_line_base(scene)),
      .parts = {.line_u95_mm = certainty.u95_mm,
                .give_mm = path::largest_give_mm(path, planned_arm),
                .tip_u95_mm = tip.u95_mm},
      .planned_s = line_s(path),
      .waits = !certainty.places.empty()};
}

}  // namespace biteline::bench
