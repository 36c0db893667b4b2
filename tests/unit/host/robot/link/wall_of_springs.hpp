// SPDX-License-Identifier: MIT
#pragma once
/// \file A wall of springs where a path presses, and its program in the simulated controller.

#include <functional>
#include <memory>

#include "hal/sim/robot/press_run.hpp"
#include "host/robot/link/ur/script.hpp"
#include "host/robot/path/checks/program_check.hpp"

namespace biteline::robot::test {

inline constexpr double k_wall_newton_per_mm = 15;

/// Springs where the path's tips are, `deeper_mm` farther in, by the time since the touch.
struct Wall {
  const path::PlannedPath& path;
  std::function<double(double touched_s)> deeper_mm;
  std::size_t near{0};
  double touched_s{0};

  Vec3 operator()(const SE3& T_base_tcp, double step_s) {
    const Vec3 tip = T_base_tcp.translation();
    const auto off = [&](std::size_t i) { return (path.waypoints[i].T_base_tcp.translation() - tip).norm(); };
    for (std::size_t i = 0; i < path.waypoints.size(); ++i) {
      if (path.waypoints[i].segment == path::Segment::Line && off(i) < off(near)) near = i;
    }
    const path::Waypoint& w = path.waypoints[near];
    const double depth_mm = (tip - w.T_base_tcp.translation()).dot(w.press_base) - deeper_mm(touched_s);
    if (depth_mm > 0 || touched_s > 0) touched_s += step_s;
    return -std::max(0.0, depth_mm) * k_wall_newton_per_mm * w.press_base;
  }
};

inline std::shared_ptr<const sim::Program> program_of(const path::CheckedPath& checked) {
  sim::Script script = *sim::parse_script(ur::urscript(checked));
  const auto arm = sim::ArmKinematics::named("ur5e");
  const sim::JointVector from_rad = checked.path().waypoints.front().q_rad;
  script.start_rad = from_rad;
  return std::make_shared<const sim::Program>(
      sim::Program::plan(script, *arm, arm->T_base_flange(from_rad), SE3::Identity()));
}

}  // namespace biteline::robot::test
