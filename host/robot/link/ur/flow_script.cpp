// SPDX-License-Identifier: MIT
#include "host/robot/link/ur/flow_script.hpp"

#include <algorithm>
#include <array>

#include "common/core/fixed_text.hpp"
#include "host/robot/link/ur/units.hpp"

namespace biteline::robot::ur {
namespace {

using path::PlannedPath;
using Row = FixedText<200>;
using Rows = FixedText<1000>;

// From here on a run's end is looked for: nearer to it than a line comes to its own end anywhere before.
constexpr double k_near_end_mm = 30;
// A place that goes slower stands; that is looked at from the first millimetre on, and so is a short run's
// end: a tool that has not set out yet comes no nearer to it.
constexpr double k_standing_mm_s = 0.5, k_first_mm = 1;
// Beyond any path, m: nothing more is looked for.
constexpr double k_never_m = 1000;

Vec3 spot_of(const PlannedPath& path, std::size_t waypoint) {
  const SE3& T = path.waypoints[waypoint].T_base_tcp;
  return T.translation() + path.standoff_mm * T.linear().col(2);
}

/// Open while there is film to lay and the place moves; its end is met, or was just passed.
std::string gun_rows(int output, double gun_off_s) {
  return Rows::format(R"(      local wanted = biteline_film
      if biteline_way > %.7f and speed < %.7f:
        wanted = 0
      end
      local nearer = left
      left = point_dist(spot, biteline_end)
      if biteline_way > biteline_near and (left <= speed * %.4f or left > nearer):
        biteline_film = 0
        biteline_near = %g
        wanted = 0
      end
      if wanted != gun:
        set_standard_digital_out(%d, wanted > 0)
        gun = wanted
      end
)",
                      k_first_mm / k_mm_per_m, k_standing_mm_s / k_mm_per_m, gun_off_s, k_never_m, output)
      .c_str();
}

/// Until the needle is closed: a pump that ends before it leaves the film's end thin.
std::string pump_rows(const path::Flow& flow) {
  return Rows::format(R"(      comes = comes - get_steptime()
      if gun > 0:
        comes = %.4f
      end
      local ratio = 0
      if gun > 0 or comes > 0:
        ratio = (speed + %.4f * (speed - before) / get_steptime()) / %.7f
      end
      if ratio < 0:
        ratio = 0
      end
      if ratio > 1:
        ratio = 1
      end
      set_standard_analog_out(%d, ratio)
)",
                      flow.gun_off_s, flow.lag_s, flow.full_mm_s / k_mm_per_m, flow.analog_output)
      .c_str();
}

}  // namespace

ToolOutputs outputs_of(const PlannedPath& path) {
  const bool flange = path.force && path.force->flange;
  return {.digital = path.digital_output,
          .analog = path.flow ? path.flow->analog_output : -1,
          .flange_on = flange ? path.force->flange->on_output : -1,
          .flange_analog = flange ? path.force->flange->analog_output : -1};
}

std::string outputs_off(const ToolOutputs& outputs, std::string_view indent) {
  const std::string begin{indent};
  std::string text;
  if (outputs.digital >= 0)
    text += begin + Row::format("set_standard_digital_out(%d, False)\n", outputs.digital).c_str();
  if (outputs.analog >= 0)
    text += begin + Row::format("set_standard_analog_out(%d, 0)\n", outputs.analog).c_str();
  if (outputs.flange_on >= 0)
    text += begin + Row::format("set_standard_digital_out(%d, False)\n", outputs.flange_on).c_str();
  if (outputs.flange_analog >= 0)
    text += begin + Row::format("set_standard_analog_out(%d, 0)\n", outputs.flange_analog).c_str();
  return text;
}

FilmEnd film_end(const PlannedPath& path, const path::PathRun& run, bool closes) {
  const double dry_mm = path.flow->dry_end_mm + (closes ? path.overlap_mm - path.flow->film_overlap_mm : 0);
  // The line's way, as the overlap is told; the tip's may be longer round a toe.
  double left_mm = dry_mm;
  std::size_t last = run.last;
  double step_mm = 0;
  for (; last > run.first + 1; --last) {
    step_mm = (path.waypoints[last].line_base - path.waypoints[last - 1].line_base).norm();
    if (step_mm > left_mm) break;
    left_mm -= step_mm;
  }
  const double back = step_mm > 0 ? std::min(left_mm / step_mm, 1.0) : 0;
  FilmEnd end{.spot_base = (1 - back) * spot_of(path, last) + back * spot_of(path, last - 1)};
  for (std::size_t i = run.first + 1; i < last; ++i)
    end.way_mm += (spot_of(path, i) - spot_of(path, i - 1)).norm();
  end.way_mm += (end.spot_base - spot_of(path, last - 1)).norm();
  return end;
}

std::string flow_purge(const PlannedPath& path) {
  const ToolOutputs outputs = outputs_of(path);
  std::string text;
  if (outputs.analog >= 0) text += Row::format("  set_standard_analog_out(%d, 1)\n", outputs.analog).view();
  text += Row::format("  set_standard_digital_out(%d, True)\n  sleep(%.4f)\n", outputs.digital,
                      path.flow->purge_s)
              .view();
  text += outputs_off(outputs);
  const double drips_s = path.flow->gun_off_s;
  return drips_s > 0 ? text + Row::format("  sleep(%.4f)\n", drips_s).c_str() : text;
}

std::string flow_thread(const PlannedPath& path) {
  const path::Flow& flow = *path.flow;
  const std::string spot =
      Row::format("pose_trans(get_target_tcp_pose(), p[0,0,%.7f,0,0,0])", path.standoff_mm / k_mm_per_m)
          .c_str();
  std::string text = R"(  global biteline_film = 0
  global biteline_way = 0
  global biteline_near = 0
  global biteline_end = p[0,0,0,0,0,0]
  thread biteline_flow():
    local last = )" + spot +
                     R"(
    local speed = 0
    local gun = 0
    local left = 0
    local comes = 0
    while True:
      sync()
      local spot = )" +
                     spot + R"(
      local gone = point_dist(spot, last)
      local before = speed
      speed = gone / get_steptime()
      last = spot
      biteline_way = biteline_way + gone
)";
  text += gun_rows(path.digital_output, flow.gun_off_s);
  if (flow.analog_output >= 0) text += pump_rows(flow);
  return text + "    end\n  end\n  biteline_flowing = run biteline_flow()\n";
}

std::string flow_begins(const PlannedPath& path, const FilmEnd& end) {
  const std::array<double, 6> p = to_ur_pose(SE3{Eigen::Translation3d{end.spot_base}});
  std::string text = Row::format("  biteline_end = p[%.7f,%.7f,%.7f,0,0,0]\n", p[0], p[1], p[2]).c_str();
  text += Row::format("  biteline_near = %.7f\n  biteline_way = 0\n  biteline_film = 1\n",
                      std::max(std::min(k_first_mm, end.way_mm / 2), end.way_mm - k_near_end_mm) / k_mm_per_m)
              .view();
  const double wait_s = path.flow->gun_on_s + path.flow->dwell_s;
  if (wait_s > 0) text += Row::format("  sleep(%.4f)\n", wait_s).view();
  return text;
}

std::string flow_ends() {
  return "  biteline_film = 0\n  sync()\n";
}

}  // namespace biteline::robot::ur
