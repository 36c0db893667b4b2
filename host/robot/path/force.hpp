// SPDX-License-Identifier: MIT
#pragma once
/// \file How hard the tool presses at each waypoint, and how far it is beside a path that it may leave.

#include <optional>
#include <span>

#include "host/robot/path/place.hpp"
#include "host/robot/path/tool_path.hpp"

namespace biteline::path {

/// Of a flange's reading from what is asked of it, as its maker tells it; below the room to its full force.
inline constexpr double k_flange_room_ratio = 1.05;

/// The path presses: it has a force, and its tool is not off.
[[nodiscard]] bool presses(const PlannedPath& path);

/// A closed table's value at a place round the line; zero of an empty one.
[[nodiscard]] double at_place(std::span<const double> by_place, double round_ratio);
[[nodiscard]] Vec3 at_place(std::span<const Vec3> by_place, double round_ratio);

/// What the sensor's noise and a bump leave of the room below the largest force.
inline constexpr double k_force_room_ratio = 1.1;

/// Directions and forces of the waypoints: on each run from the touch over `ramp_mm` to the set force and
/// back.  With what was learned the force is the one that the sensor tells when the set one presses: the
/// sensor is zeroed at each run's beginning; never above what leaves room to the process's largest, nor below
/// its contact.  Nothing for a process without a force.  Pre: as many points as
/// waypoints.
void set_forces(PlannedPath& path, std::span<const ToolPoint> points, const Process& process);

/// Of a tip from its place on the path.  Where the arm's force mode presses the tip may leave it along the
/// force within the process's reach: then only what lies across the force counts.
[[nodiscard]] double off_path_mm(const PlannedPath& path, const PathPlace& place, const Vec3& tip_base);
/// The same from one waypoint.
[[nodiscard]] double off_waypoint_mm(const PlannedPath& path, std::size_t waypoint, const Vec3& tip_base);
/// What the tool feels at a place of the path, N in base axes: the arm's own reading, or what a flange reads,
/// as a share of its full force, against the way that it presses.  Nothing: neither was told.
[[nodiscard]] std::optional<Vec3> felt_newton(const PlannedPath& path, const PathPlace& place,
                                              const std::optional<Vec3>& force_base_newton,
                                              const std::optional<double>& flange_ratio);
/// Into the shoe, at a place of the path; zero beside the line.
[[nodiscard]] Vec3 press_at(const PlannedPath& path, const PathPlace& place);

}  // namespace biteline::path
