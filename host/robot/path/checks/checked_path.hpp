// SPDX-License-Identifier: MIT
#pragma once
/// \file A complete path, the checks on it, and the type that only a path which passed them can have.

#include <optional>
#include <string>
#include <vector>

#include "host/robot/path/checks/line_check.hpp"
#include "host/robot/path/checks/obstacles.hpp"
#include "host/robot/path/timing.hpp"

namespace biteline::path {

struct Waypoint {
  SE3 T_base_tcp;
  kinematics::Joints q_rad;
  Segment segment{Segment::Line};
  double speed_mm_s{0};
  double time_s{0};
  double arc_mm{0};
  Vec3 line_base;  ///< the point of the bite line it belongs to
  /// Radius about the tip, in the plane across its way, that holds with 95 % where it ought to be; only on
  /// the line; none: not known.
  std::optional<double> u95_mm{};
  double speed_ratio{1};                       ///< the tip's, of the process's speed along the line
  std::optional<double> acceleration_mm_s2{};  ///< of the move to it; none: the process's
  Vec3 press_base{Vec3::Zero()};  ///< of a path with a force: into the shoe, unit; zero beside the line
  double force_newton{0};         ///< along it, with what was learned
  double round_ratio{0};          ///< of its place on the line: of the line's length from the heel's end
};

struct PlannedPath {
  std::string robot;
  std::string process;
  SE3 T_flange_tcp;
  std::optional<Payload> payload{};
  Motion motion;  ///< as the process has it, but for the spacing, which is what the path was made with
  int digital_output{-1};
  std::optional<Flow> flow{};                 ///< of the process
  std::optional<Force> force{};               ///< of the process
  double standoff_mm{0};                      ///< of the place that is worked, from the tip along its axis
  double overlap_mm{0};                       ///< of the first run on the line with itself; 0: it stays open
  bool tool_off{false};                       ///< the output is switched off where it would be switched on
  std::vector<kinematics::Joints> via_rad{};  ///< postures on the arm's way to the first waypoint (way_there)
  std::optional<std::size_t> purge_via{};     ///< the one of them where the tool purges
  std::optional<double> way_there_rad_s{};    ///< of the joints on it; none: the process's
  std::optional<kinematics::Joints> purge_rad{};  ///< where its flow purges on the way there; none: nowhere
  double give_mm{0};                              ///< the arm's largest, on the line and across it (give.hpp)
  double tip_u95_mm{0};                           ///< of the taught tip; 0: none was taught
  std::vector<Waypoint> waypoints;
};

/// A path that passed every check.  What moves a robot takes this type and no other; only check_path() makes
/// one, and find_way_there() adds the checked way to its beginning.
class CheckedPath {
 public:
  [[nodiscard]] const PlannedPath& path() const { return path_; }
  [[nodiscard]] double duration_s() const { return path_.waypoints.back().time_s; }

 private:
  friend struct PathChecker;
  friend struct WayFinder;
  explicit CheckedPath(PlannedPath path) : path_{std::move(path)} {}
  PlannedPath path_;
};

struct CheckOutcome {
  std::vector<Check> checks;
  std::optional<CheckedPath> path;  ///< present when all passed
};

/// What a path must keep to beyond the arm's and the process's own limits.
struct CheckLimits {
  double least_singularity{0.04};
  double least_clearance_mm{2};
  double least_tip_mm{1};  ///< of the tip to the table; less than a thin sole, more than a table is uneven
};

/// Everything anew from joints and poses, trusting nothing of how they were made: pose and joints agree,
/// reach, joint limits, speed and acceleration of tip and joints, singularity, jumps of the wrist,
/// collisions, and what a controller's program asks (program_check).
[[nodiscard]] CheckOutcome check_path(PlannedPath path, const kinematics::ArmModel& arm,
                                      const CollisionModel& collisions, const CheckLimits& limits);

}  // namespace biteline::path
