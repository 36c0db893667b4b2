// SPDX-License-Identifier: MIT
#include "host/robot/link/ur/force_script.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "common/core/fixed_text.hpp"
#include "host/robot/link/ur/units.hpp"

namespace biteline::robot::ur {
namespace {

using path::PlannedPath;
using ForceRows = FixedText<2000>;

// force_mode's limits for axes that follow the program: how far they may be off before the controller stops.
constexpr double k_across_m = 0.02, k_turn_rad = 0.1;
// Of the reading, so that noise ends no run.
constexpr double k_reading_lag_s = 0.01;
// The zero and the change of the mode take a controller some cycles.
constexpr double k_settle_s = 0.1;
// Between two knots all is straight: within 3 % of a right direction's force at 0.05 rad.
constexpr double k_turn_between_rad = 0.05, k_force_between_ratio = 0.02, k_way_between_mm = 10;

/// The shortest turn that brings z there.
std::array<double, 3> turn_to(const Vec3& press_base) {
  const Vec3 axis = Vec3::UnitZ().cross(press_base);
  const double sine = axis.norm(), angle_rad = std::atan2(sine, press_base.z());
  if (sine < 1e-9) return {press_base.z() < 0 ? angle_rad : 0.0, 0, 0};
  return {axis.x() / sine * angle_rad, axis.y() / sine * angle_rad, axis.z() / sine * angle_rad};
}

std::string indented(int depth) {
  return std::string(static_cast<std::size_t>(2 * depth), ' ');
}

/// Straight between two knots.
std::string between(const ForceKnot& a, const ForceKnot& b, int depth) {
  const double way_m = std::max(b.way_m - a.way_m, 1e-6);
  const auto row = [&](const char* name, double from, double to) {
    return indented(depth) + std::string{ForceRows::format("%s = %.6f + %.6f * (biteline_pressed - %.6f)\n",
                                                           name, from, (to - from) / way_m, a.way_m)
                                             .view()};
  };
  return row("rx", a.turn_rad[0], b.turn_rad[0]) + row("ry", a.turn_rad[1], b.turn_rad[1]) +
         row("rz", a.turn_rad[2], b.turn_rad[2]) + row("want", a.newton, b.newton);
}

/// By halves, so that a place is found in some ten comparisons.
std::string looked_up(std::span<const ForceKnot> knots, int depth) {
  if (knots.size() == 2) return between(knots[0], knots[1], depth);
  const std::size_t middle = knots.size() / 2;
  return indented(depth) +
         std::string{ForceRows::format("if biteline_pressed < %.6f:\n", knots[middle].way_m).view()} +
         looked_up(knots.first(middle + 1), depth + 1) + indented(depth) + "else:\n" +
         looked_up(knots.subspan(middle), depth + 1) + indented(depth) + "end\n";
}

std::string word_row(int depth, ForceWord word) {
  return indented(depth) + std::string{ForceRows::format("write_output_integer_register(%d, %d)\n",
                                                         k_force_register, static_cast<int>(word))
                                           .view()};
}

/// What the thread looks at each cycle; `fault` is the word that ends the program.
std::string looks(const path::Force& force) {
  return ForceRows::format(R"(        local into = pose_trans(p[0,0,0,rx,ry,rz], p[0,0,1,0,0,0])
        local felt = get_tcp_force()
        local reading = 0 - (felt[0] * into[0] + felt[1] * into[1] + felt[2] * into[2])
        press = press + (reading - press) * get_steptime() / (get_steptime() + %.4f)
        local speed = %.6f
        local fault = 0
        if touched == 0:
          speed = %.6f
          since = since + get_steptime()
          if press > %.4f:
            touched = 1
            write_output_integer_register(%d, %d)
          elif since > %.4f:
            fault = %d
          end
        elif press < %.4f:
          without = without + get_steptime()
          if without > %.4f:
            fault = %d
          end
        else:
          without = 0
        end
        if press > %.4f:
          fault = %d
        end
)",
                           k_reading_lag_s, force.limit_mm_s / k_mm_per_m, force.approach_mm_s / k_mm_per_m,
                           force.contact_newton, k_force_register, static_cast<int>(ForceWord::Presses),
                           force.reach_mm / force.approach_mm_s + k_settle_s / 2,
                           static_cast<int>(ForceWord::Untouched), force.contact_newton / 2, force.lost_s,
                           static_cast<int>(ForceWord::Lost), force.most_newton,
                           static_cast<int>(ForceWord::TooHigh))
      .c_str();
}

}  // namespace

std::vector<ForceKnot> force_knots(const PlannedPath& path) {
  std::vector<ForceKnot> knots;
  double way_mm = 0;
  Vec3 told_base = Vec3::Zero();
  double told_mm = 0;
  const auto add = [&](const path::Waypoint& w, double at_mm) {
    knots.push_back(
        {.way_m = at_mm / k_mm_per_m, .turn_rad = turn_to(w.press_base), .newton = w.force_newton});
    told_base = w.press_base;
    told_mm = at_mm;
  };
  for (const path::PathRun& run : path::runs_of(path, path::Segment::Line)) {
    for (std::size_t i = run.first; i <= run.last; ++i) {
      const path::Waypoint& w = path.waypoints[i];
      if (i > run.first)
        way_mm += (w.T_base_tcp.translation() - path.waypoints[i - 1].T_base_tcp.translation()).norm();
      const bool end = i == run.first || i == run.last;
      const double changed = knots.empty() ? 0 : std::abs(w.force_newton - knots.back().newton);
      if (end || std::acos(std::clamp(told_base.dot(w.press_base), -1.0, 1.0)) > k_turn_between_rad ||
          changed > k_force_between_ratio * path.force->set_newton || way_mm - told_mm > k_way_between_mm)
        add(w, way_mm);
    }
  }
  return knots;
}

std::string force_thread(const PlannedPath& path, const ToolOutputs& outputs) {
  const path::Force& force = *path.force;
  std::string text = R"(  global biteline_press = 0
  global biteline_pressed = 0
  thread biteline_force():
)" + word_row(2, ForceWord::None) +
                     R"(    local last = get_target_tcp_pose()
    local on = 0
    local touched = 0
    local since = 0
    local without = 0
    local press = 0
    local rx = 0
    local ry = 0
    local rz = 0
    local want = 0
    while True:
      sync()
      local here = get_target_tcp_pose()
      if biteline_press == 2:
        biteline_pressed = biteline_pressed + point_dist(here, last)
      end
      last = here
      if biteline_press == 3:
        zero_ftsensor()
        biteline_press = 0
      elif biteline_press == 0:
        if on > 0:
          end_force_mode()
          on = 0
)" + word_row(5, ForceWord::None) +
                     R"(        end
      else:
        if on == 0:
          on = 1
          touched = 0
          since = 0
          without = 0
          press = 0
)" + word_row(5, ForceWord::Seeks);
  text += ForceRows::format(
              "          force_mode_set_damping(%.4f)\n          force_mode_set_gain_scaling(%.4f)\n",
              force.damping_ratio, force.gain_ratio)
              .view();
  text += "        end\n";
  text += looked_up(force_knots(path), 4);
  text += looks(force);
  text += ForceRows::format(R"(        if touched == 0:
          want = %.4f
        end
        if fault > 0:
          end_force_mode()
)",
                            force.set_newton)
              .view();
  text += outputs_off(outputs, "          ");
  text += ForceRows::format(R"(          write_output_integer_register(%d, fault)
          sync()
          halt
        end
        force_mode(p[0,0,0,rx,ry,rz], [0,0,1,0,0,0], [0,0,want,0,0,0], 2, [%.4f,%.4f,speed,%.4f,%.4f,%.4f])
      end
    end
  end
)",
                            k_force_register, k_across_m, k_across_m, k_turn_rad, k_turn_rad, k_turn_rad)
              .view();
  return text + "  biteline_forcing = run biteline_force()\n";
}

std::string force_zero() {
  return ForceRows::format("  biteline_press = 3\n  sleep(%.4f)\n", k_settle_s).c_str();
}

std::string force_begins(const PlannedPath& path, double way_mm) {
  const double touch_s = path.force->reach_mm / path.force->approach_mm_s + k_settle_s;
  return ForceRows::format(
             "  biteline_pressed = %.6f\n  biteline_press = 1\n  sleep(%.4f)\n  biteline_press = 2\n",
             way_mm / k_mm_per_m, touch_s)
      .c_str();
}

std::string force_ends() {
  return ForceRows::format("  biteline_press = 0\n  sleep(%.4f)\n", k_settle_s).c_str();
}

}  // namespace biteline::robot::ur
