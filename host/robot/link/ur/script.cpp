// SPDX-License-Identifier: MIT
#include "host/robot/link/ur/script.hpp"

#include <algorithm>
#include <utility>

#include "common/core/fixed_text.hpp"
#include "host/robot/link/ur/flange_script.hpp"
#include "host/robot/link/ur/flow_script.hpp"
#include "host/robot/link/ur/force_script.hpp"
#include "host/robot/link/ur/units.hpp"
#include "host/robot/path/checks/program_check.hpp"
#include "host/robot/path/force.hpp"
#include "host/robot/path/targets.hpp"

namespace biteline::robot::ur {
namespace {

using path::PlannedPath;
using path::Segment;
using path::Waypoint;

// Towards the first waypoint from wherever the arm stands: to its speed in the time in which a joint comes to
// the highest such speed within its own limit, and never more slowly than URScript's default.
constexpr double k_home_acceleration_rad_s2 = 1.4, k_home_ramp_s = 0.3;
// movep and movel need a speed above zero.  Nothing is planned slower: a tip that is faster than its plan is
// stopped.
constexpr double k_least_speed_mm_s = 0.01;

using Line = FixedText<400>;

Line pose_text(const SE3& T) {
  const std::array<double, 6> p = to_ur_pose(T);
  return Line::format("p[%.7f,%.7f,%.7f,%.8f,%.8f,%.8f]", p[0], p[1], p[2], p[3], p[4], p[5]);
}

Line move_text(const char* command, const Waypoint& to, const PlannedPath& path, double speed_mm_s,
               double blend_mm) {
  return Line::format("  %s(%s, a=%.4f, v=%.6f, r=%.5f)\n", command, pose_text(to.T_base_tcp).c_str(),
                      to.acceleration_mm_s2.value_or(path.motion.acceleration_mm_s2) / k_mm_per_m,
                      std::max(speed_mm_s, k_least_speed_mm_s) / k_mm_per_m, blend_mm / k_mm_per_m);
}

Line payload_text(const path::Payload& payload) {
  const Vec3 centre_m = payload.centre_flange_mm / k_mm_per_m;
  return Line::format("  set_payload(%.3f, [%.5f,%.5f,%.5f])\n", payload.mass_kg, centre_m.x(), centre_m.y(),
                      centre_m.z());
}

Line joint_move_text(const kinematics::Joints& q, double speed_rad_s) {
  return Line::format("  movej([%.8f,%.8f,%.8f,%.8f,%.8f,%.8f], a=%.3f, v=%.3f)\n", q[0], q[1], q[2], q[3],
                      q[4], q[5], std::max(k_home_acceleration_rad_s2, speed_rad_s / k_home_ramp_s),
                      speed_rad_s);
}

/// The fastest speed of a straight way, which the controller ramps up to and down from by itself.
double fastest_mm_s(const PlannedPath& path, std::size_t first, std::size_t last) {
  double fastest = 0;
  for (std::size_t i = first; i <= last; ++i) fastest = std::max(fastest, path.waypoints[i].speed_mm_s);
  if (fastest > 0) return fastest;
  // From stop to stop in one step, as it is timed.
  const Waypoint& from = path.waypoints[first];
  const bool worked = from.segment == Segment::Line && path.waypoints[last].segment == Segment::Line;
  return worked ? path.motion.speed_mm_s * from.speed_ratio : path.motion.approach_speed_mm_s;
}

/// Straight ways between the waypoints where the tip stops.
std::string straight_moves(const PlannedPath& path, std::size_t from, std::size_t to) {
  std::string text;
  std::size_t begin = from;
  for (std::size_t i = from + 1; i <= to; ++i) {
    if (path.waypoints[i].speed_mm_s > 0 && i != to) continue;
    text += move_text("movel", path.waypoints[i], path, fastest_mm_s(path, begin, i), 0).view();
    begin = i;
  }
  return text;
}

/// From target to target with a blend round each: the line, and the ways between its stretches.
std::string rounded_moves(const char* command, const PlannedPath& path, const path::PathRun& run) {
  std::string text;
  const auto& w = path.waypoints;
  const std::vector<double> blend_mm = path::blend_radii_mm(path::tips_of(path, run), path.motion.blend_mm);
  for (std::size_t i = run.first + 1; i <= run.last; ++i) {
    text += move_text(command, w[i], path, fastest_mm_s(path, i - 1, i), blend_mm[i - run.first]).view();
  }
  return text;
}

/// Of the tip's way over a run.
double length_mm(const PlannedPath& path, const path::PathRun& run) {
  double way_mm = 0;
  for (std::size_t i = run.first; i < run.last; ++i)
    way_mm +=
        (path.waypoints[i + 1].T_base_tcp.translation() - path.waypoints[i].T_base_tcp.translation()).norm();
  return way_mm;
}

/// Ends with its program, whether that comes to its end or is stopped.
std::string dead_man(int beat_register, const ToolOutputs& outputs) {
  std::string text = Line::format("  rtde_set_watchdog(\"input_int_register_%d\", %g, \"stop\")\n",
                                  beat_register, k_watchdog_hz)
                         .c_str();
  const Line look = Line::format("read_input_integer_register(%d)\n", beat_register);
  text += "  thread biteline_dead_man():\n";
  text += "    local last = " + std::string{look.view()};
  text += "    local still = 0\n";
  text += Line::format("    while still < %d:\n", k_most_still_looks).view();
  text += Line::format("      sleep(%g)\n", k_look_s).view();
  text += "      local beat = " + std::string{look.view()};
  text += "      if beat == last:\n        still = still + 1\n      else:\n        still = 0\n      end\n";
  text += "      last = beat\n    end\n";
  text += outputs_off(outputs, "    ");
  // The output is set within its frame; the program ends in the next one.
  text += "    sync()\n    halt\n  end\n";
  return text + "  biteline_watch = run biteline_dead_man()\n";
}

/// Before a run on the line, where the tool stands at its beginning.
std::string tool_begins(const PlannedPath& path, const path::PathRun& run, bool closes) {
  if (path.tool_off || path.digital_output < 0) return outputs_off(outputs_of(path));
  std::string text = Line::format("  set_standard_digital_out(%d, True)\n", path.digital_output).c_str();
  return path.flow ? text + flow_begins(path, film_end(path, run, closes)) : text;
}

}  // namespace

std::string urscript(const path::CheckedPath& checked, const std::optional<int>& beat_register) {
  const PlannedPath& path = checked.path();
  const auto& w = path.waypoints;
  std::string text = std::string{"def "} + k_program_name + "():\n";
  const ToolOutputs outputs = outputs_of(path);
  const bool flows = path.flow && !path.tool_off, presses = path::presses(path);
  if (beat_register) text += dead_man(*beat_register, outputs);
  text += Line::format("  set_tcp(%s)\n", pose_text(path.T_flange_tcp).c_str()).view();
  if (path.payload) text += payload_text(*path.payload).view();
  // Whatever an earlier program left on, the arm does not travel with it.
  text += outputs_off(outputs);
  const double way_rad_s = path.way_there_rad_s.value_or(path.motion.way_there_rad_s);
  for (std::size_t i = 0; i < path.via_rad.size(); ++i) {
    text += joint_move_text(path.via_rad[i], way_rad_s).view();
    if (flows && path.purge_via == i) text += flow_purge(path);
  }
  if (flows) text += flow_thread(path);
  const bool by_flange = presses && path.force->flange;
  if (presses) text += by_flange ? flange_thread(path, outputs) : force_thread(path, outputs);
  text += joint_move_text(w.front().q_rad, way_rad_s).view();
  std::size_t at = 0;
  double pressed_mm = 0;
  bool closes = path.overlap_mm > 0;
  for (const path::PathRun& run : path::rounded_runs(path)) {
    const bool on_line = w[run.last].segment == Segment::Line;
    if (presses && on_line) {
      // The last step of the way in: near to the touch, and beside the shoe.
      const std::size_t free = std::max(at, run.first > 0 ? run.first - 1 : 0);
      text += straight_moves(path, at, free) + (by_flange ? flange_out() : force_zero());
      at = free;
    }
    text += straight_moves(path, at, run.first);
    if (on_line) text += tool_begins(path, run, std::exchange(closes, false));
    if (presses && on_line)
      text += by_flange ? flange_begins(path, pressed_mm) : force_begins(path, pressed_mm);
    text += rounded_moves(on_line ? "movep" : "movel", path, run);
    if (on_line && flows) text += flow_ends();
    if (presses && on_line) {
      text += force_ends();
      pressed_mm += length_mm(path, run);
    }
    if (on_line) text += outputs_off(outputs);
    at = run.last;
  }
  text += straight_moves(path, at, w.size() - 1);
  if (flows) text += "  kill biteline_flowing\n";
  if (presses) text += "  kill biteline_forcing\n";
  if (beat_register) text += "  kill biteline_watch\n";
  text += "end\n";
  return text;
}

}  // namespace biteline::robot::ur
