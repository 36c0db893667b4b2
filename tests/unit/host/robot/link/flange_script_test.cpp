// SPDX-License-Identifier: MIT
// A program that presses by a simulated flange, cycle by cycle in made time, on a wall of springs.
#include "host/robot/link/ur/flange_script.hpp"

#include <CppUTest/TestHarness.h>

#include <cmath>

#include "host/robot/link/path_watch.hpp"
#include "host/robot/path/checks/force_check.hpp"
#include "host/robot/path/force.hpp"
#include "host/robot/path/force_told.hpp"
#include "host/robot/path/place.hpp"
#include "tests/unit/host/robot/link/planned.hpp"
#include "tests/unit/host/robot/link/wall_of_springs.hpp"

namespace biteline::robot::ur {
namespace {

constexpr double k_pressed_newton = 20;

path::PlanRequest flange_request() {
  path::PlanRequest asked = test::plan_request("grind.yaml");
  asked.process.tool.free_turn_rad = 0;
  asked.process.placement.outwards = path::Outwards::Normal;
  asked.process.force = path::Force{
      .set_newton = k_pressed_newton,
      .flange = path::Flange{.on_output = 4, .ready_input = 4, .tilt_rad = asked.process.placement.tilt_rad}};
  return asked;
}

const path::CheckedPath& by_flange() {
  static const path::PlanOutcome outcome = path::plan(flange_request());
  CHECK_TEXT(outcome.path.has_value(), outcome.reason().c_str());
  return *outcome.path;
}

sim::PressRun flange_run(const std::function<double(double)>& deeper_mm, sim::FlangeFacts facts = {}) {
  facts.axis_tcp = path::axis_tcp(*by_flange().path().force->flange);
  test::Wall wall{.path = by_flange().path(), .deeper_mm = deeper_mm};
  return sim::press_along(test::program_of(by_flange()), facts, std::ref(wall), k_force_register);
}

int told_last(const sim::PressRun& run) {
  return run.steps.back().told;
}

/// As the controller tells it: the arm is where the program has it.
std::vector<path::TrackSample> flange_track(const sim::PressRun& run) {
  const path::PlannedPath& path = by_flange().path();
  std::vector<path::TrackSample> track;
  path::AlongPath along{path};
  for (const sim::PressStep& step : run.steps) {
    SE3 T_base_tcp = path.waypoints.front().T_base_tcp;
    if (const auto place = along.next(step.tip_base)) T_base_tcp = path::pose_at(path, *place);
    T_base_tcp.translation() = step.tip_base;
    track.push_back({.time_s = step.time_s,
                     .T_base_tcp = T_base_tcp,
                     .flange_ratio = step.volts / 10,
                     .presses = step.told == static_cast<int>(ForceWord::Presses)});
  }
  return track;
}

std::optional<HaltReason> watched_over(const sim::PressRun& run) {
  const path::PlannedPath& path = by_flange().path();
  RobotState state{.q_rad = path.waypoints.front().q_rad,
                   .T_base_tcp = path.waypoints.front().T_base_tcp,
                   .T_flange_tcp = path.T_flange_tcp,
                   .speed_ratio = 1};
  PathWatch watch{path, {}, state};
  const std::vector<path::TrackSample> track = flange_track(run);
  for (std::size_t i = 0; i < track.size(); ++i) {
    state.sampled = RobotClock::time_point{Nanoseconds{static_cast<std::int64_t>(track[i].time_s * 1e9) + 1}};
    state.T_base_tcp = track[i].T_base_tcp;
    state.flange_ratio = track[i].flange_ratio;
    state.force_word = run.steps[i].told;
    if (auto halt = watch.look(state)) return halt;
  }
  return std::nullopt;
}

}  // namespace

TEST_GROUP(FlangeScript){};

/// Also on a wall 5 mm beside its place, which no force mode with a reach of 3 mm would find.
TEST(FlangeScript, ItsForceIsThereAndTold) {
  for (const double deeper_mm : {-5.0, 0.0, 5.0}) {
    const sim::PressRun run = flange_run([&](double) { return deeper_mm; });
    CHECK_FALSE(run.halted);
    const auto halt = watched_over(run);
    CHECK_TEXT(!halt, halt ? halt->reason.c_str() : "");
    const auto track = flange_track(run);
    const auto told = path::force_told(by_flange().path(), track, {});
    CHECK(told.has_value());
    CHECK(told->samples > 1000);
    DOUBLES_EQUAL(k_pressed_newton, told->mean_newton, 0.02 * k_pressed_newton);
    // Friction and the pressure's lag in the ramp: what is missing falls below 3 N in three of its lags.
    const double all_s = 0.002 * static_cast<double>(told->samples);
    CHECK_COMPARE(told->within, >, 1 - 3 * (0.03 + 0.05) / all_s);
    // In truth, too: what the wall feels along the stroke is the pressure less its friction.
    double worst = 0;
    std::size_t level = 0;
    for (std::size_t i = run.steps.size() / 3; i < run.steps.size() / 2; ++i) {
      if (run.steps[i].told != static_cast<int>(ForceWord::Presses)) continue;
      worst = std::max(worst, std::abs(run.steps[i].true_newton.norm() - k_pressed_newton));
      ++level;
    }
    CHECK(level > 100);
    CHECK_COMPARE(worst, <, 0.15 * k_pressed_newton);
  }
}

TEST(FlangeScript, ADeadOneEndsTheProgramAndIsNamed) {
  const sim::PressRun run = flange_run([](double) { return 0.0; }, {.dead_after_s = 3});
  CHECK(run.halted);
  LONGS_EQUAL(static_cast<int>(ForceWord::FlangeDead), told_last(run));
  const auto halt = watched_over(run);
  CHECK(halt.has_value());
  CHECK_TEXT(halt->code == Halt::FlangeDead, halt->reason.c_str());
  // What it was switched on with is off, by its own thread.
  CHECK_FALSE(run.steps.back().force_mode && run.steps.back().volts > 1);
}

TEST(FlangeScript, AShoeThatIsNotThereEndsTheProgram) {
  const sim::PressRun run = flange_run([](double) { return 100.0; });
  CHECK(run.halted);
  LONGS_EQUAL(static_cast<int>(ForceWord::Untouched), told_last(run));
}

/// At the end of its stroke it has no force any more, and says so by its line.
TEST(FlangeScript, AShoeThatGoesAwayEndsTheProgram) {
  const sim::PressRun run = flange_run([](double touched_s) { return touched_s > 2 ? 100.0 : 0.0; });
  CHECK(run.halted);
  LONGS_EQUAL(static_cast<int>(ForceWord::FlangeDead), told_last(run));
}

TEST(FlangeScript, NothingOfForceModeIsAsked) {
  const std::string text = urscript(by_flange());
  CHECK(text.find("force_mode") == std::string::npos && text.find("zero_ftsensor") == std::string::npos);
  STRCMP_CONTAINS("set_standard_digital_out(4, False)", text.c_str());
}

/// The gate's word on a flange that cannot do it.
TEST(FlangeScript, MoreForceThanItGivesOrAStrokeAsideIsRefused) {
  path::PlanRequest weak = flange_request();
  weak.process.force->flange->full_newton = 18;
  STRCMP_CONTAINS("flange's force", path::plan(weak).reason().c_str());
  path::PlanRequest aside = flange_request();
  aside.process.force->flange->tilt_rad += 0.5;
  STRCMP_CONTAINS("flange's stroke", path::plan(aside).reason().c_str());
}

/// The arm keeps its path: a tip that leaves it along the force is off.
TEST(FlangeScript, TheArmMayNotLeaveThePathAlongTheForce) {
  const path::PlannedPath& path = by_flange().path();
  const auto on_line = std::ranges::find(path.waypoints, path::Segment::Line, &path::Waypoint::segment);
  const Vec3 off = on_line->T_base_tcp.translation() + 2.5 * on_line->press_base;
  DOUBLES_EQUAL(2.5,
                path::off_waypoint_mm(path, static_cast<std::size_t>(on_line - path.waypoints.begin()), off),
                1e-9);
}

}  // namespace biteline::robot::ur
