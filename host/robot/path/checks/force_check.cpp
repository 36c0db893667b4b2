// SPDX-License-Identifier: MIT
#include "host/robot/path/checks/force_check.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "host/robot/path/checks/program_check.hpp"
#include "host/robot/path/force.hpp"

namespace biteline::path {
namespace {

/// A tool that presses along its way pushes the arm on, or back: the sine of 17 degrees.
constexpr double k_most_along = 0.3;
/// Of rounding: a force that was held to its limit keeps it.
constexpr double k_rounding_ratio = 1e-9;

/// A figure that is no number fails.
struct WorstOfForce {
  double value{0}, arc_mm{-1};
  void larger(double other, double at_mm) {
    if (std::isnan(value) || other <= value) return;
    value = other;
    arc_mm = at_mm;
  }
};

Check force_check_of(const char* name, const WorstOfForce& worst, double limit, const char* unit,
                     const char* failure) {
  Check check{.name = name,
              .passed = worst.value <= limit,
              .value = worst.value,
              .limit = limit,
              .unit = unit,
              .arc_mm = worst.arc_mm,
              .detail = {}};
  if (!check.passed) check.detail = failure;
  return check;
}

Check direction_check(const PlannedPath& path) {
  constexpr double k_unit = 1e-6;
  WorstOfForce along;
  for (const PathRun& run : runs_of(path, Segment::Line)) {
    for (std::size_t i = run.first; i <= run.last; ++i) {
      const Waypoint& here = path.waypoints[i];
      const bool last = i == run.last;
      const Vec3 way = last && i == run.first
                           ? Vec3{Vec3::Zero()}
                           : Vec3{path.waypoints[last ? i : i + 1].T_base_tcp.translation() -
                                  path.waypoints[last ? i - 1 : i].T_base_tcp.translation()};
      along.larger(
          std::abs(here.press_base.norm() - 1) < k_unit ? std::abs(way.normalized().dot(here.press_base)) : 1,
          here.arc_mm);
    }
  }
  return force_check_of("force direction", along, k_most_along, "of it along the way",
                        "the force does not stand across the way");
}

Check force_size_check(const PlannedPath& path) {
  const Force& force = *path.force;
  WorstOfForce worst;
  for (const Waypoint& w : path.waypoints) {
    if (w.segment != Segment::Line) continue;
    worst.larger(k_force_room_ratio * (1 - k_rounding_ratio) * w.force_newton, w.arc_mm);
    if (!(w.force_newton >= force.contact_newton * (1 - k_rounding_ratio)))
      worst.larger(2 * force.most_newton, w.arc_mm);
  }
  return force_check_of("force", worst, force.most_newton, "N", "the force leaves no room to its limits");
}

Check flange_force_check(const PlannedPath& path) {
  WorstOfForce worst;
  for (const Waypoint& w : path.waypoints)
    if (w.segment == Segment::Line) worst.larger(k_flange_room_ratio * w.force_newton, w.arc_mm);
  return force_check_of("flange's force", worst, path.force->flange->full_newton, "N",
                        "the force is more than the flange gives (force.flange_full_n)");
}

/// Across its stroke a flange gives no force: at 15 degrees 3 % are missing, and its guides rub.
Check flange_axis_check(const PlannedPath& path) {
  constexpr double k_most_rad = 0.2618, k_deg_per_rad = 57.29577951308232;
  const Vec3 axis = axis_tcp(*path.force->flange);
  WorstOfForce worst;
  for (const Waypoint& w : path.waypoints) {
    if (w.segment != Segment::Line) continue;
    const double cosine = (w.T_base_tcp.linear() * axis).dot(w.press_base);
    worst.larger(std::acos(std::clamp(cosine, -1.0, 1.0)) * k_deg_per_rad, w.arc_mm);
  }
  return force_check_of("flange's stroke", worst, k_most_rad * k_deg_per_rad, "degrees from the force",
                        "the flange's stroke does not lie along the force: force.flange_tilt_deg, lead_deg, "
                        "free_turn_deg and outwards: normal");
}

}  // namespace

bool has_force_sensor(const std::string& robot) {
  static constexpr std::array k_without{"UR3", "UR5", "UR10"};
  return robot.starts_with("UR") && std::ranges::find(k_without, robot) == k_without.end();
}

std::vector<Check> force_checks(const PlannedPath& path) {
  if (!path.force || path.tool_off) return {};
  if (path.force->flange)
    return {direction_check(path), force_size_check(path), flange_force_check(path), flange_axis_check(path)};
  const bool can = has_force_sensor(path.robot);
  Check arm{.name = "force mode",
            .passed = can,
            .value = can ? 1.0 : 0.0,
            .limit = 1,
            .unit = "",
            .arc_mm = -1,
            .detail = can ? "" : "this arm has no force sensor in its flange: plan without force.set_n"};
  return {direction_check(path), force_size_check(path), std::move(arm)};
}

}  // namespace biteline::path
