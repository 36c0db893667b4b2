// SPDX-License-Identifier: MIT
#include "host/robot/path/force.hpp"

#include <algorithm>
#include <cmath>

#include "host/robot/path/checks/program_check.hpp"

namespace biteline::path {
namespace {

double off_mm(const PlannedPath& path, const Vec3& off, const Vec3& press_base) {
  if (!presses(path) || path.force->flange || press_base.isZero()) return off.norm();
  const double along_mm = off.dot(press_base);
  if (!(std::abs(along_mm) <= path.force->reach_mm)) return off.norm();
  return (off - along_mm * press_base).norm();
}

template <class Value>
Value between_places(std::span<const Value> by_place, double round_ratio, const Value& zero) {
  if (by_place.empty()) return zero;
  const double place = (round_ratio - std::floor(round_ratio)) * static_cast<double>(by_place.size());
  const auto before = static_cast<std::size_t>(place) % by_place.size();
  const double part = place - std::floor(place);
  return (1 - part) * by_place[before] + part * by_place[(before + 1) % by_place.size()];
}

/// Of the ends of the line's runs where the way in and out has none of its own.
void carry_to_neighbours(std::vector<Waypoint>& waypoints) {
  for (std::size_t i = 1; i < waypoints.size(); ++i) {
    if (waypoints[i].press_base.isZero() && waypoints[i].segment == Segment::Retreat)
      waypoints[i].press_base = waypoints[i - 1].press_base;
  }
}

}  // namespace

bool presses(const PlannedPath& path) {
  return path.force && !path.tool_off;
}

double at_place(std::span<const double> by_place, double round_ratio) {
  return between_places(by_place, round_ratio, 0.0);
}
Vec3 at_place(std::span<const Vec3> by_place, double round_ratio) {
  return between_places(by_place, round_ratio, Vec3{Vec3::Zero()});
}

void set_forces(PlannedPath& path, std::span<const ToolPoint> points, const Process& process) {
  if (!process.force) return;
  const Force& force = *process.force;
  const ForceLearned learned = process.force_learned.value_or(ForceLearned{});
  std::vector<Waypoint>& w = path.waypoints;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (w[i].segment != Segment::Line) continue;
    w[i].press_base = points[i].press_base;
    w[i].round_ratio = points[i].round_ratio;
  }
  for (const PathRun& run : runs_of(path, Segment::Line)) {
    const Vec3 zero_tcp = at_place(std::span<const Vec3>{learned.error_tcp}, w[run.first].round_ratio);
    for (std::size_t i = run.first; i <= run.last; ++i) {
      const double from_end_mm =
          std::min(w[i].arc_mm - w[run.first].arc_mm, w[run.last].arc_mm - w[i].arc_mm);
      const double ramp = std::clamp(from_end_mm / force.ramp_mm, 0.0, 1.0);
      const Vec3 error_tcp = at_place(std::span<const Vec3>{learned.error_tcp}, w[i].round_ratio) - zero_tcp;
      const Vec3 press_tcp = w[i].T_base_tcp.linear().transpose() * w[i].press_base;
      const double taught = force.set_newton +
                            at_place(std::span<const double>{learned.ahead_newton}, w[i].round_ratio) -
                            error_tcp.dot(press_tcp);
      const double full = std::clamp(taught, force.contact_newton, force.most_newton / k_force_room_ratio);
      w[i].force_newton = force.contact_newton + ramp * (full - force.contact_newton);
    }
  }
  carry_to_neighbours(w);
}

Vec3 press_at(const PlannedPath& path, const PathPlace& place) {
  const Vec3 &a = path.waypoints[place.segment].press_base, &b = path.waypoints[place.segment + 1].press_base;
  const Vec3 mixed = (1 - place.fraction) * a + place.fraction * b;
  return mixed.isZero(1e-6) ? Vec3{Vec3::Zero()} : Vec3{mixed.normalized()};
}

std::optional<Vec3> felt_newton(const PlannedPath& path, const PathPlace& place,
                                const std::optional<Vec3>& force_base_newton,
                                const std::optional<double>& flange_ratio) {
  if (!path.force || !path.force->flange) return force_base_newton;
  if (!flange_ratio) return std::nullopt;
  return Vec3{-*flange_ratio * path.force->flange->full_newton * press_at(path, place)};
}

double off_path_mm(const PlannedPath& path, const PathPlace& place, const Vec3& tip_base) {
  return off_mm(path, tip_base - pose_at(path, place).translation(), press_at(path, place));
}

double off_waypoint_mm(const PlannedPath& path, std::size_t waypoint, const Vec3& tip_base) {
  const Waypoint& w = path.waypoints[waypoint];
  return off_mm(path, tip_base - w.T_base_tcp.translation(), w.press_base);
}

}  // namespace biteline::path
