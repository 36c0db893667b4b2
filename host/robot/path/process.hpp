// SPDX-License-Identifier: MIT
#pragma once
/// \file What is done along the line, and with which tool: the process YAML.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/config/yaml_reader.hpp"
#include "common/core/result.hpp"
#include "common/geometry/se3.hpp"

namespace biteline::path {

/// movep takes no smaller radius, as users of RoboDK's forum report; 1 mm until a real controller says
/// otherwise (docs/real-controller.md).
constexpr double k_least_blend_mm = 1;

constexpr std::size_t k_most_zones = 20;

/// A tip that has not come on by so much stands; noise of one that stands is below.
constexpr double k_least_advance_mm = 0.2;

/// A tip that stands off goes at least at this share of the speed along the line, in a hollow.
inline constexpr double k_least_tip_ratio = 0.4;

/// What the arm carries beyond its flange, for the controller's own model of forces.
struct Payload {
  double mass_kg{0};
  Vec3 centre_flange_mm{Vec3::Zero()};
};

/// The tool: z of its frame is its axis, out of the flange; its tip is the origin.
struct Tool {
  std::string name{};  ///< by which the cell knows that it is mounted; empty: nobody asks
  SE3 T_flange_tcp{SE3::Identity()};
  double body_radius_mm{
      20};  ///< of a cylinder round the axis, from the flange down to `contact_length_mm` from the tip
  double contact_length_mm{15};      ///< what of the tip may come close to the shoe
  std::optional<Payload> payload{};  ///< nothing: of a head that no program of ours moves
  double free_turn_rad{0};           ///< how far it may be turned about its axis, either way; pi: it is round
};

/// What "outwards" is: level, at right angles to the line, or the upper's own normal.  Level is the default:
/// an upper's wall leans out over the crease on one shoe and in on the next (by 20 degrees either way), and
/// the tool's room above the table and beside the last must not depend on that.
enum class Outwards { Level, Normal };

/// Where the tip stands relative to the line; up: at right angles to outwards and the line.
struct TipPlacement {
  Outwards outwards{Outwards::Level};
  double outward_mm{0};
  double up_mm{0};
  double standoff_mm{0};  ///< of the tip, back along the tool's axis (spray)
  double tilt_rad{0};     ///< 0: the tool points straight against outwards; pi/2: straight down
  double lead_rad{0};     ///< > 0: the tool's body leans back, the tip goes ahead
};

/// What the tool covers at once: a contact width, or the cone of a spray at its standoff.
struct Coverage {
  double contact_width_mm{0};
  double cone_rad{0};
};

struct Motion {
  double speed_mm_s{50};           ///< along the line
  double minimum_speed_mm_s{5};    ///< slower than this the process burns or floods; the path is refused
  double acceleration_mm_s2{500};  ///< along the path
  double cross_acceleration_mm_s2{500};  ///< in curves: limits the speed to sqrt(a / curvature)
  double joint_speed_ratio{0.5};         ///< of the arm's own limits
  std::optional<double> give_mm{};       ///< of the arm, across the line; none: not looked at
  double spacing_mm{2};                  ///< of the program's targets; grows where the blends need it
  double blend_mm{1};                    ///< radius round a target; at least k_least_blend_mm
  double chord_error_mm{0.2};            ///< how far straight moves and blends may leave the tip's way
  double overlap_mm{10};                 ///< beyond the starting point, so that the seam is covered
  double approach_mm{30};                ///< back along the tool's axis
  double approach_speed_mm_s{30};
  double draw_back_mm{0};  ///< farther back along it, at the speed between places
  double lift_mm{80};      ///< from there straight up, before and after
  double transfer_speed_mm_s{150};
  /// Of the joints to the path's beginning: slow, a person may be near.  Faster where neither arm nor tool
  /// then goes faster than `transfer_speed_mm_s` (way_there.hpp).
  double way_there_rad_s{0.5};
};

/// When an arm that follows is stopped.  Angles in the file are degrees.
struct FollowLimits {
  double off_path_mm{2};  ///< of the tip: twice what the widest usual blend (0.8 mm) and the arm's lag take
  double off_path_rad{0.0524};  ///< of the tool's direction and turn: 3 degrees are 2 mm at the end of 40 mm
  double off_way_rad{0.0349};   ///< of a joint on the way there: 2 degrees are 35 mm a metre away
  double late_s{3};             ///< behind or ahead of the plan, and a quarter of the planned time besides
  double stall_s{2};            ///< without coming on: a tool that dwells burns or floods
  double silence_s{0.5};        ///< without a new state: 60 of the slowest controller's (125 Hz)
  double covered{0.99};         ///< share of the line's waypoints, or the job is not done
};

/// How much leaves the tool along the line, and when it begins and ends there.  Times in the file are ms.
struct Flow {
  double gun_on_s{0};   ///< from its output's switching on until the first of it is on the shoe
  double gun_off_s{0};  ///< from its switching off until the last of it is
  double dwell_s{0};    ///< that the tool stands at its beginning then
  /// Of film on film where the line closes; the rest of the overlap is gone with the gun off.
  double film_overlap_mm{0};
  int analog_output{-1};  ///< goes with the speed of the place that is worked; -1: none
  double full_mm_s{0};    ///< the speed that it is full at; at least the line's fastest
  double lag_s{0};        ///< of the flow behind the output: the output is ahead by so much
  double dry_end_mm{0};   ///< of each run's end without film; of no file: test lines (flow_test.hpp)
  double purge_s{0};      ///< open at full flow before the line, beside the shoe; 0: not at all
  Vec3 purge_at_base{Vec3::Zero()};  ///< where the tip is then, in the arm's base, the tool straight down
};

/// A device between the arm's flange and the tool that keeps a force by itself, over its stroke along an axis
/// of its own.  In the middle of the stroke the tip stands at its place.  Its lines are the controller's
/// standard ones.
struct Flange {
  int analog_output{0}, analog_input{0};  ///< 0 or 1: the set force, and its reading; full at full_newton
  int on_output{-1};                      ///< digital, 0 to 7: it presses
  int ready_input{-1};                    ///< digital, 0 to 7: no fault, and not at an end of its stroke
  double full_newton{100};
  double stroke_mm{30};
  double tilt_rad{0};  ///< of its axis from the tool's, about the line, as a tool is tilted
};
/// Along it the tool comes out, in tcp.
[[nodiscard]] Vec3 axis_tcp(const Flange& flange);

/// How hard the tool presses along the line.  The arm's force mode keeps the force and the path across it; or
/// a flange keeps the force and the arm the path.
struct Force {
  double set_newton{20};
  double contact_newton{3};   ///< from here on the tool touches; half of it: it does not any more
  double approach_mm_s{5};    ///< of the tip until it touches
  double reach_mm{3};         ///< along the force, how far the tip may leave its path either way
  double ramp_mm{5};          ///< of each run's beginning and end, from the touch to the set force and back
  double limit_mm_s{20};      ///< of the tip along the force
  double damping_ratio{0.3};  ///< of force mode, 0 to 1
  double gain_ratio{1};       ///< of force mode, 0 to 2; a hard shoe asks for less
  double most_newton{60};     ///< above it the run ends
  double lost_s{0.15};        ///< without touching: the run ends
  /// Of the set force, from the arm's own reading; farther off for follow.stall_s the run is stopped.  0: not
  /// watched.
  double tolerance_ratio{0.5};
  std::optional<Flange> flange{};  ///< presses; none: the arm's force mode does
};

/// Of a model's shoes at one cell (force_learning.hpp), by even places round the line from the heel's end,
/// anticlockwise.
struct ForceLearned {
  double set_newton{0};  ///< that it was learned at
  int air_runs{0}, shoes{0};
  std::vector<Vec3> error_tcp{};  ///< N, of the sensor: what it tells, in tcp axes, where nothing presses
  std::vector<double> ahead_newton{};  ///< added to the set force beyond that
};

/// What must hold before a path is sent.
struct GateLimits {
  double scan_age_s{120};  ///< from the scan's end: the shoe may be moved later on
  int lost_in_a_row{2};    ///< frames, profiles or edges: 2 at 1 mm a frame are less than a tool's width
  double start_rad{
      0.00349};          ///< of each joint since the way was checked: 0.2 degrees are 3.5 mm a metre away
  bool approval{false};  ///< somebody must have said yes to this scan: a person, or `automatic_above`
  std::optional<double> automatic_above{};  ///< a line at least as sure as this is approved by itself
  std::optional<double> tolerance_mm{};  ///< of the line's uncertainty (U95), where the process asks for one
  std::optional<double> tip_tolerance_mm{};  ///< of the tip's bound (tip_bound.hpp), likewise
};

/// Where the closed line is entered.
enum class Start {
  Auto,     ///< where a seam harms least: straight and away from toe and heel
  Nearest,  ///< nearest to the robot's base
  Farthest,
};

/// A zone's speed is at most so many times the process's, and so is that of a tip that stands off.
inline constexpr double k_most_speed_ratio = 5;
/// Of the tip, along the line.
inline constexpr double k_most_speed_mm_s = 1000;

/// What follows the work: nothing, a second look, or one that has what is missing worked once more.
enum class AfterWork { None, Look, Rework };

/// A part of the line that is worked in a way of its own, or left out.  What is "by" is added to the
/// process's.
struct Zone {
  enum class Where { Stretch, Heel, Toe };
  std::string name;
  Where where{Where::Stretch};
  /// Of a stretch: shares of the line's length from the heel's end, anticlockwise seen from above; from above
  /// to: over the heel's end.
  double from_ratio{0}, to_ratio{0};
  double reach_ratio{0.15};  ///< of heel and toe: share of the shoe's length, from its end
  bool left_out{false};
  double outward_by_mm{0}, up_by_mm{0};
  double tilt_by_rad{0}, lead_by_rad{0};
  double speed_ratio{1};  ///< of the process's speed
  int passes{1};
  double ramp_mm{5};  ///< within its ends, over which offsets and angles change
};

/// A part of the line by its own length, mm from its first point; over that where `to_mm` is less.
struct Piece {
  double from_mm{0}, to_mm{0};
  double speed_ratio{1};  ///< of what process and zones have there
};

/// A scanning head's two eyes, in tcp.
struct Sight {
  Vec3 camera_tcp{Vec3::Zero()};
  Vec3 laser_tcp{Vec3::Zero()};  ///< where its light comes from
};

struct Process {
  std::string name;
  Tool tool;
  std::optional<Sight> sight{};  ///< of a scan: what it works on must be seen
  TipPlacement placement;
  Coverage coverage;
  Motion motion;
  FollowLimits follow{};
  GateLimits gate{};
  Start start{Start::Auto};
  AfterWork after_work{AfterWork::None};
  double look_tolerance_mm{0.5};  ///< of a second look: an edge farther off its place is a fault
  std::string next_process{};     ///< that the same shoe is worked with then, by its file's name; empty: none
  int digital_output{-1};         ///< switched on along the line; -1: none
  std::optional<Flow> flow{};     ///< none: on from the beginning to the end, at whatever speed
  std::optional<Force> force{};   ///< none: by position alone
  std::optional<ForceLearned> force_learned{};  ///< of the model; of no process file
  std::string foot{};         ///< that its stretches are told on, left or right; empty: on either one
  std::vector<Zone> zones{};  ///< where two meet, the first one counts
  /// What of the line is worked of all that the zones leave; empty: all.  Of no file: rework and test lines.
  std::vector<Piece> only{};
};

/// Of a tool or of a process that another one names: letters, digits, '.', '_' and '-', at most 64 bytes.
[[nodiscard]] bool is_name(const std::string& text);

/// Width worked at once, mm: the contact's, or the cone's at the standoff.
[[nodiscard]] double covered_width_mm(const Process& process);

/// Strict: every fault names file, key and line.  Angles in the file are degrees.
[[nodiscard]] Result<Process> read_process(const std::filesystem::path& file);

/// A process with the keys that it was read from.
struct ProcessText {
  Process process;
  config::KeysAsked keys;
};
/// The same of a text (YAML, and so JSON); `name` stands for the file in faults.
[[nodiscard]] Result<ProcessText> parse_process(const std::string& text, const std::string& name);
/// Every key that a process may have, in the reader's order, with ranges and defaults.
[[nodiscard]] config::KeysAsked process_keys();

}  // namespace biteline::path
