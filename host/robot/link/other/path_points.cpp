// SPDX-License-Identifier: MIT
#include "host/robot/link/other/path_points.hpp"

#include <algorithm>

#include "host/robot/path/checks/program_check.hpp"
#include "host/robot/path/targets.hpp"

namespace biteline::robot::other {
namespace {

using arm_link::PathPoint;
using path::PlannedPath;
using path::Segment;

// As ur/script.cpp has them.
constexpr double k_least_acceleration_rad_s2 = 1.4, k_joint_ramp_s = 0.3, k_least_speed_mm_s = 0.01;

class Maker {
 public:
  Maker(const PlannedPath& path, std::uint32_t name) : path_{path} {
    made_.begin.path = name;
    made_.begin.T_flange_tcp = path.T_flange_tcp;
    made_.begin.output = path.digital_output;
    if (path.payload) made_.begin.mass_kg = path.payload->mass_kg;
    if (path.payload) made_.begin.centre_flange_mm = path.payload->centre_flange_mm;
  }

  PathPoints make() {
    const double way_rad_s = path_.way_there_rad_s.value_or(path_.motion.way_there_rad_s);
    for (const kinematics::Joints& via : path_.via_rad) turn_to(via, SE3::Identity(), way_rad_s);
    turn_to(path_.waypoints.front().q_rad, path_.waypoints.front().T_base_tcp, way_rad_s);
    std::size_t at = 0;
    for (const path::PathRun& run : path::rounded_runs(path_)) {
      go_straight(at, run.first);
      go_round(run);
      at = run.last;
    }
    go_straight(at, path_.waypoints.size() - 1);
    made_.begin.points = static_cast<std::uint32_t>(made_.points.size());
    return std::move(made_);
  }

 private:
  PathPoint& add() {
    PathPoint& point = made_.points.emplace_back();
    point.path = made_.begin.path;
    point.index = static_cast<std::uint32_t>(made_.points.size() - 1);
    return point;
  }

  void turn_to(const kinematics::Joints& q_rad, const SE3& T_base_tcp, double speed_rad_s) {
    PathPoint& point = add();
    point.move = PathPoint::Move::Joint;
    point.T_base_tcp = T_base_tcp;
    point.q_rad = q_rad;
    point.speed = speed_rad_s;
    point.acceleration = std::max(k_least_acceleration_rad_s2, speed_rad_s / k_joint_ramp_s);
  }

  void go_to(std::size_t waypoint, double speed_mm_s, double blend_mm, bool tool_on) {
    PathPoint& point = add();
    point.tool_on = tool_on;
    point.T_base_tcp = path_.waypoints[waypoint].T_base_tcp;
    point.q_rad = path_.waypoints[waypoint].q_rad;
    point.speed = std::max(speed_mm_s, k_least_speed_mm_s);
    point.acceleration =
        path_.waypoints[waypoint].acceleration_mm_s2.value_or(path_.motion.acceleration_mm_s2);
    point.blend_mm = blend_mm;
  }

  /// The fastest speed of a straight way, which the controller ramps up to and down from by itself.
  [[nodiscard]] double fastest_mm_s(std::size_t first, std::size_t last) const {
    double fastest = 0;
    for (std::size_t i = first; i <= last; ++i) fastest = std::max(fastest, path_.waypoints[i].speed_mm_s);
    if (fastest > 0) return fastest;
    const bool worked =
        path_.waypoints[first].segment == Segment::Line && path_.waypoints[last].segment == Segment::Line;
    return worked ? path_.motion.speed_mm_s * path_.waypoints[first].speed_ratio
                  : path_.motion.approach_speed_mm_s;
  }

  /// Between the waypoints where the tip stops.
  void go_straight(std::size_t from, std::size_t to) {
    std::size_t begin = from;
    for (std::size_t i = from + 1; i <= to; ++i) {
      if (path_.waypoints[i].speed_mm_s > 0 && i != to) continue;
      go_to(i, fastest_mm_s(begin, i), 0, false);
      begin = i;
    }
  }

  void go_round(const path::PathRun& run) {
    const bool on =
        path_.waypoints[run.last].segment == Segment::Line && path_.digital_output >= 0 && !path_.tool_off;
    const std::vector<double> blend_mm =
        path::blend_radii_mm(path::tips_of(path_, run), path_.motion.blend_mm);
    for (std::size_t i = run.first + 1; i <= run.last; ++i)
      go_to(i, fastest_mm_s(i - 1, i), blend_mm[i - run.first], on);
  }

  const PlannedPath& path_;
  PathPoints made_;
};

}  // namespace

PathPoints path_points(const path::CheckedPath& path, std::uint32_t name) {
  return Maker{path.path(), name}.make();
}

}  // namespace biteline::robot::other
