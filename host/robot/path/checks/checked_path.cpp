// SPDX-License-Identifier: MIT
#include "host/robot/path/checks/checked_path.hpp"

#include <algorithm>
#include <cmath>

#include "host/robot/kinematics/chain.hpp"
#include "host/robot/path/checks/fixture.hpp"
#include "host/robot/path/checks/force_check.hpp"
#include "host/robot/path/checks/program_check.hpp"

namespace biteline::path {
namespace {

using kinematics::ArmModel;
using kinematics::Joints;

// Joints and pose are two statements of one thing; the inverse meets poses far better than this.
constexpr double k_agree_mm = 0.005;
// Between two neighbouring waypoints no joint may turn more than this: it would be another configuration.
constexpr double k_jump_rad = 0.35;
// Speeds are planned at points and checked over the steps between them.
constexpr double k_step_tolerance = 1.1;

/// The worst of a figure along the path.  A figure that is no number is the worst there is, and stays it: no
/// limit holds for it.
struct Worst {
  double value;
  double arc_mm{-1};
  std::string detail{};

  void larger(double other, double where_mm, const std::string& words = {}) {
    if (!std::isnan(value) && !(other <= value))
      *this = {.value = other, .arc_mm = where_mm, .detail = words};
  }
  void smaller(double other, double where_mm, const std::string& words = {}) {
    if (!std::isnan(value) && !(other >= value))
      *this = {.value = other, .arc_mm = where_mm, .detail = words};
  }
};

Check checked(std::string name, const Worst& worst, bool passed, double limit, std::string unit,
              const std::string& failure) {
  return {.name = std::move(name),
          .passed = passed,
          .value = worst.value,
          .limit = limit,
          .unit = std::move(unit),
          .arc_mm = worst.arc_mm,
          .detail = passed ? "" : failure + (worst.detail.empty() ? "" : ": " + worst.detail)};
}

Check at_most(std::string name, const Worst& worst, double limit, std::string unit,
              const std::string& failure) {
  return checked(std::move(name), worst, worst.value <= limit, limit, std::move(unit), failure);
}

Check at_least(std::string name, const Worst& worst, double limit, std::string unit,
               const std::string& failure) {
  return checked(std::move(name), worst, worst.value >= limit, limit, std::move(unit), failure);
}

std::string joint_name(int joint) {
  return "joint " + std::to_string(joint + 1);
}

Check pose_check(const PlannedPath& path, const ArmModel& arm) {
  Worst worst{.value = 0};
  for (const Waypoint& w : path.waypoints) {
    const SE3 left = w.T_base_tcp.inverse() * kinematics::forward(arm, w.q_rad) * path.T_flange_tcp;
    // A turn counts as much as it moves a point 100 mm away.
    worst.larger(left.translation().norm() + 100 * geometry::log_so3(left.linear()).norm(), w.arc_mm);
  }
  return at_most("joints reach the poses", worst, k_agree_mm, "mm", "the joints do not reach the pose");
}

Check limit_check(const PlannedPath& path, const ArmModel& arm) {
  Worst worst{.value = -1e9};
  for (const Waypoint& w : path.waypoints) {
    for (int joint = 0; joint < 6; ++joint) {
      const double over = std::max(w.q_rad[joint] - arm.limits.maximum_rad[joint],
                                   arm.limits.minimum_rad[joint] - w.q_rad[joint]);
      worst.larger(over, w.arc_mm, joint_name(joint));
    }
  }
  return at_most("joint limits", worst, 0, "rad", "beyond its limit");
}

void add_motion_checks(const PlannedPath& path, const ArmModel& arm, std::vector<Check>& checks) {
  Worst jump{.value = 0}, joint_speed{.value = 0}, spacing{.value = 0}, speed{.value = 0}, slow{.value = 1e9},
      order{.value = 1e9};
  const double end_of_ramp_mm =
      path.motion.speed_mm_s * path.motion.speed_mm_s / (2 * path.motion.acceleration_mm_s2);
  // Of the stretch that a waypoint of the line belongs to.
  double line_begin_mm = 0, line_end_mm = 0;
  const std::vector<PathRun> runs = runs_of(path, Segment::Line);
  auto run = runs.begin();
  for (std::size_t i = 0; i + 1 < path.waypoints.size(); ++i) {
    const Waypoint& a = path.waypoints[i];
    const Waypoint& b = path.waypoints[i + 1];
    while (run != runs.end() && run->last < i) ++run;
    if (run != runs.end()) {
      line_begin_mm = path.waypoints[run->first].arc_mm;
      line_end_mm = path.waypoints[run->last].arc_mm;
    }
    const double step_s = b.time_s - a.time_s;
    const double step_mm = (b.T_base_tcp.translation() - a.T_base_tcp.translation()).norm();
    order.smaller(step_s, a.arc_mm);
    if (step_s <= 0) continue;  // NaN goes on and fails below
    for (int joint = 0; joint < 6; ++joint) {
      const double turn_rad = std::abs(b.q_rad[joint] - a.q_rad[joint]);
      jump.larger(turn_rad, a.arc_mm, joint_name(joint));
      joint_speed.larger(turn_rad / step_s / arm.limits.speed_rad_s[joint], a.arc_mm, joint_name(joint));
    }
    if (a.segment != Segment::Line || b.segment != Segment::Line) continue;
    spacing.larger(step_mm, a.arc_mm);
    // As the process's own speed, whatever share of it is meant here.
    const double ratio = std::min(k_most_speed_ratio, std::max(a.speed_ratio, b.speed_ratio));
    speed.larger(step_mm / step_s / ratio, a.arc_mm);
    if (a.arc_mm > line_begin_mm + end_of_ramp_mm && b.arc_mm < line_end_mm - end_of_ramp_mm)
      slow.smaller(b.speed_mm_s, a.arc_mm);
  }
  const Motion& motion = path.motion;
  checks.push_back(at_least("time runs forward", order, 1e-6, "s", "two waypoints at one instant"));
  checks.push_back(
      at_most("no wrist jump", jump, k_jump_rad, "rad", "a joint jumps between neighbouring points"));
  checks.push_back(at_most("joint speed", joint_speed, motion.joint_speed_ratio * k_step_tolerance,
                           "of its limit", "too fast"));
  // A short stretch has one step, up to twice as wide.
  checks.push_back(at_most("path spacing", spacing,
                           std::max(1.5 * motion.spacing_mm + 1, 2 * motion.spacing_mm), "mm",
                           "waypoints too far apart"));
  checks.push_back(at_most("speed", speed, motion.speed_mm_s * k_step_tolerance, "mm/s",
                           "faster than the process allows"));
  checks.push_back(at_least("no dwelling", slow, motion.minimum_speed_mm_s, "mm/s",
                            "the tool must slow down below the process's least speed"));
}

Check acceleration_check(const PlannedPath& path, const ArmModel& arm) {
  // Through the same function as the planner's, on the waypoints themselves.
  ToolPath tool_path;
  JointPath joints;
  Timing timing;
  for (const Waypoint& w : path.waypoints) {
    tool_path.points.push_back({.T_base_tcp = w.T_base_tcp,
                                .segment = w.segment,
                                .arc_mm = w.arc_mm,
                                .curvature_per_mm = 0,
                                .line_base = w.line_base});
    joints.q_rad.push_back(w.q_rad);
    timing.time_s.push_back(w.time_s);
  }
  const JointAcceleration worst = worst_acceleration(arm, tool_path, joints, timing);
  // The planner shares the limit out at points; over steps the two shares may add up a little beyond.
  return at_most("joint acceleration",
                 {.value = worst.ratio, .arc_mm = worst.arc_mm, .detail = joint_name(worst.joint)}, 1.5,
                 "of its limit", "accelerates too hard");
}

/// What may come close to the shoe, the tool's end, is exempt from the body's clearance; nothing is from the
/// table.
Check tip_check(const PlannedPath& path, const CollisionModel& collisions, double least_mm) {
  Worst worst{.value = 1e9};
  for (const Waypoint& w : path.waypoints)
    worst.smaller(
        w.T_base_tcp.translation().z() - floor_mm(collisions.surroundings(), w.T_base_tcp.translation()),
        w.arc_mm);
  return at_least("tip above the table", worst, least_mm, "mm",
                  collisions.surroundings().fixture
                      ? "the tip comes too near to the table, or to what the shoe stands on"
                      : "the tip comes too near to the table");
}

Check singularity_check(const PlannedPath& path, const ArmModel& arm, double least) {
  Worst worst{.value = 1e9};
  for (const Waypoint& w : path.waypoints) {
    const kinematics::Singularity s = kinematics::singularity(arm, w.q_rad);
    worst.smaller(s.worst(), w.arc_mm, s.worst_name());
  }
  return at_least("singularity", worst, least, "of 1", "too near to a singularity");
}

Check clearance_check(const PlannedPath& path, const ArmModel& arm, const CollisionModel& collisions,
                      double least_mm) {
  constexpr double k_enough_mm = 50;
  Worst worst{.value = k_enough_mm};
  for (const Waypoint& w : path.waypoints) {
    const Clearance c = collisions.clearance(kinematics::joint_frames(arm, w.q_rad), k_enough_mm);
    worst.smaller(c.mm, w.arc_mm, c.what);
  }
  return at_least("clearance", worst, least_mm, "mm", "collision");
}

}  // namespace

struct PathChecker {
  static CheckedPath passed(PlannedPath path) { return CheckedPath{std::move(path)}; }
};

CheckOutcome check_path(PlannedPath path, const ArmModel& arm, const CollisionModel& collisions,
                        const CheckLimits& limits) {
  CheckOutcome out;
  if (path.waypoints.size() < 3) {
    out.checks.push_back({.name = "waypoints",
                          .passed = false,
                          .value = static_cast<double>(path.waypoints.size()),
                          .limit = 3,
                          .unit = "points",
                          .arc_mm = -1,
                          .detail = "no path"});
    return out;
  }
  out.checks.push_back(pose_check(path, arm));
  out.checks.push_back(limit_check(path, arm));
  add_motion_checks(path, arm, out.checks);
  out.checks.push_back(acceleration_check(path, arm));
  out.checks.push_back(singularity_check(path, arm, limits.least_singularity));
  out.checks.push_back(tip_check(path, collisions, limits.least_tip_mm));
  out.checks.push_back(clearance_check(path, arm, collisions, limits.least_clearance_mm));
  for (Check& check : program_checks(path)) out.checks.push_back(std::move(check));
  for (Check& check : force_checks(path)) out.checks.push_back(std::move(check));
  if (all_passed(out.checks)) out.path = PathChecker::passed(std::move(path));
  return out;
}

}  // namespace biteline::path
