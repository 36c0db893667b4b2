// SPDX-License-Identifier: MIT
// A program that presses, cycle by cycle in the simulated controller's made time, on a wall of springs.
#include "host/robot/link/ur/force_script.hpp"

#include <CppUTest/TestHarness.h>

#include <cmath>
#include <memory>

#include "hal/sim/robot/press_run.hpp"
#include "host/robot/link/path_watch.hpp"
#include "host/robot/link/ur/script.hpp"
#include "host/robot/path/checks/force_check.hpp"
#include "host/robot/path/first_run.hpp"
#include "host/robot/path/force.hpp"
#include "host/robot/path/force_told.hpp"
#include "host/robot/path/place.hpp"
#include "tests/unit/host/robot/link/planned.hpp"
#include "tests/unit/host/robot/link/wall_of_springs.hpp"

namespace biteline::robot::ur {
namespace {

constexpr double k_set_newton = 20, k_wall_newton_per_mm = test::k_wall_newton_per_mm;

path::PlanRequest pressing_request() {
  path::PlanRequest asked = test::plan_request("grind.yaml");
  asked.process.force = path::Force{.set_newton = k_set_newton, .gain_ratio = 1.5};
  return asked;
}

const path::CheckedPath& pressing() {
  static const path::PlanOutcome outcome = path::plan(pressing_request());
  CHECK_TEXT(outcome.path.has_value(), outcome.reason().c_str());
  return *outcome.path;
}

sim::PressRun run_on(const std::function<double(double)>& deeper_mm, const sim::ForceFacts& facts = {},
                     const path::CheckedPath& checked = pressing()) {
  test::Wall wall{.path = checked.path(), .deeper_mm = deeper_mm};
  return sim::press_along(test::program_of(checked), facts, std::ref(wall), k_force_register);
}

int last_word(const sim::PressRun& run) {
  return run.steps.back().told;
}

/// Of the force from the set one, root mean square, in the time in force mode without its ends.
double off_newton(const sim::PressRun& run) {
  std::vector<double> pressed;
  for (const sim::PressStep& step : run.steps) {
    if (step.force_mode) pressed.push_back(step.true_newton.norm());
  }
  double sum = 0;
  const std::size_t from = pressed.size() / 4, to = pressed.size() * 9 / 10;
  for (std::size_t i = from; i < to; ++i) sum += std::pow(pressed[i] - k_set_newton, 2);
  return std::sqrt(sum / static_cast<double>(to - from));
}

/// The run as the controller tells it, with the tool turned as it is planned.
std::vector<path::TrackSample> track_of(const sim::PressRun& run, const path::PlannedPath& path) {
  std::vector<path::TrackSample> track;
  path::AlongPath along{path};
  for (const sim::PressStep& step : run.steps) {
    SE3 T_base_tcp = path.waypoints.front().T_base_tcp;
    if (const auto place = along.next(step.tip_base)) T_base_tcp = path::pose_at(path, *place);
    T_base_tcp.translation() = step.tip_base + step.off_base;
    track.push_back({.time_s = step.time_s,
                     .T_base_tcp = T_base_tcp,
                     .force_base_newton = step.told_newton,
                     .presses = step.told == static_cast<int>(ForceWord::Presses)});
  }
  return track;
}

/// What the host's watch says of it.
std::optional<HaltReason> watch_over(const sim::PressRun& run, const path::CheckedPath& checked) {
  const path::PlannedPath& path = checked.path();
  RobotState state{.q_rad = path.waypoints.front().q_rad,
                   .T_base_tcp = path.waypoints.front().T_base_tcp,
                   .T_flange_tcp = path.T_flange_tcp,
                   .speed_ratio = 1};
  PathWatch watch{path, {}, state};
  const std::vector<path::TrackSample> track = track_of(run, path);
  for (std::size_t i = 0; i < track.size(); ++i) {
    state.sampled = RobotClock::time_point{Nanoseconds{static_cast<std::int64_t>(track[i].time_s * 1e9) + 1}};
    state.T_base_tcp = track[i].T_base_tcp;
    state.force_base_newton = track[i].force_base_newton;
    state.force_word = run.steps[i].told;
    if (auto halt = watch.look(state)) return halt;
  }
  return std::nullopt;
}

}  // namespace

TEST_GROUP(ForceScript){};

/// Told is what pressed: within what the regulator leaves, and as far in as springs give way at that force.
TEST(ForceScript, TheForceAndTheTipsWayInAreTold) {
  for (const double deeper_mm : {0.0, 1.0}) {
    const sim::PressRun run = run_on([&](double) { return deeper_mm; });
    const auto told = path::force_told(pressing().path(), track_of(run, pressing().path()), {});
    CHECK(told.has_value());
    CHECK(told->samples > 1000);
    // Behind the ramp what is missing of 17 N falls below 3 N (15 %) in 1.7 time constants: those of the
    // regulator (k_force_lag_s) and of the reading's lag (50 ms) together, and one more for the ramp itself.
    const double all_s = 0.002 * static_cast<double>(told->samples),
                 behind_s = 2.7 * (path::k_force_lag_s + 0.05);
    CHECK_COMPARE(told->within, >, 1 - behind_s / all_s);
    DOUBLES_EQUAL(k_set_newton, told->mean_newton, 0.05 * k_set_newton);
    DOUBLES_EQUAL(deeper_mm + k_set_newton / k_wall_newton_per_mm, told->along_mm,
                  0.05 * k_set_newton / k_wall_newton_per_mm);
    CHECK(told->learn.size() == told->samples);
  }
}

/// A disc that wears while it works keeps its force, goes farther in, and is stopped where its reach ends.
TEST(ForceScript, WornToolIsStoppedWhereItsReachEnds) {
  const sim::PressRun slow = run_on([](double touched_s) { return 0.05 * touched_s; });
  CHECK_FALSE(watch_over(slow, pressing()).has_value());
  CHECK(off_newton(slow) < 0.05 * k_set_newton);
  const sim::PressRun fast = run_on([](double touched_s) { return 0.5 * touched_s; });
  const auto halt = watch_over(fast, pressing());
  CHECK(halt.has_value());
  CHECK_TEXT(halt->code == Halt::OffPath, halt->reason.c_str());
}

/// A sensor whose reading runs away: the regulator follows it, off the shoe or into it, until the reach ends
/// or the program itself finds no contact.
TEST(ForceScript, SensorThatDriftsIsStopped) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const sim::PressRun run =
        run_on([](double) { return 0.0; }, {.drift_newton_per_s = 20, .noise_seed = seed});
    const auto halt = watch_over(run, pressing());
    CHECK(halt.has_value());
    const bool named = halt->code == Halt::OffPath || halt->code == Halt::ContactLost ||
                       halt->code == Halt::ForceTooHigh || halt->code == Halt::NoContact;
    CHECK_TEXT(named, halt->reason.c_str());
  }
}

/// What was learned never asks for more than leaves room to the largest force.
TEST(ForceScript, LearnedForceStaysBelowTheProcessesLargest) {
  path::PlanRequest taught = pressing_request();
  taught.process.force->most_newton = 1.2 * k_set_newton;
  taught.process.force_learned =
      path::ForceLearned{.set_newton = k_set_newton,
                         .shoes = 1,
                         .error_tcp = {},
                         .ahead_newton = std::vector<double>(path::k_force_places, 0.5 * k_set_newton)};
  const path::PlanOutcome planned = path::plan(taught);
  CHECK_TEXT(planned.path.has_value(), planned.reason().c_str());
  double most_newton = 0;
  for (const path::Waypoint& w : planned.path->path().waypoints)
    most_newton = std::max(most_newton, w.force_newton);
  DOUBLES_EQUAL(1.2 * k_set_newton / path::k_force_room_ratio, most_newton, 1e-6);
}

/// The wall is where the path is, and a millimetre deeper: a regulator with a wall of springs has no error
/// left but what the line's turns make of it.
TEST(ForceScript, PressesWithTheSetForceWhereverTheWallIs) {
  for (const double deeper_mm : {0.0, 1.0}) {
    const sim::PressRun run = run_on([&](double) { return deeper_mm; });
    CHECK_FALSE(run.halted);
    LONGS_EQUAL(static_cast<int>(ForceWord::None), last_word(run));
    CHECK(off_newton(run) < 0.05 * k_set_newton);
    // Force mode ends with the line: the tip is back on its way before the program ends.
    DOUBLES_EQUAL(0, run.steps.back().off_base.norm(), 0.01);
  }
}

TEST(ForceScript, ShoeThatIsNotThereEndsTheProgram) {
  const sim::PressRun run = run_on([](double) { return 100.0; });
  CHECK(run.halted);
  LONGS_EQUAL(static_cast<int>(ForceWord::Untouched), last_word(run));
  // The reach, and what the tip goes within the time to settle.
  const path::Force& force = *pressing().path().force;
  CHECK(run.steps.back().off_base.norm() < force.reach_mm + 0.1 * force.approach_mm_s);
}

/// What is taken away in mid-line: the program ends itself while the tip has gone no farther than its speed
/// along the force lets it.
TEST(ForceScript, ContactThatIsLostEndsTheProgram) {
  const sim::PressRun run = run_on([](double touched_s) { return touched_s > 4 ? 100.0 : 0.0; });
  CHECK(run.halted);
  LONGS_EQUAL(static_cast<int>(ForceWord::Lost), last_word(run));
  const path::Force& force = *pressing().path().force;
  // Lost for so long, and what the reading's lag of 10 ms makes of 20 N.
  CHECK(run.steps.back().off_base.norm() < (force.lost_s + 0.05) * force.limit_mm_s + 2);
}

TEST(ForceScript, ForceThatIsTooHighEndsTheProgram) {
  const sim::PressRun run = run_on([](double touched_s) { return touched_s > 4 ? -6.0 : 0.0; });
  CHECK(run.halted);
  LONGS_EQUAL(static_cast<int>(ForceWord::TooHigh), last_word(run));
}

/// The sensor's error by the place, learned beside the shoe, is taken off.  Three times what was measured, so
/// that the regulator's own error (under 5 %) is small against it.
TEST(ForceScript, WhatAnAirRunTeachesTakesOffTheSensorsError) {
  const sim::ForceFacts facts{.place_newton = 3.3, .seed = 3};
  const path::PlanOutcome air = path::plan(path::force_air_run(pressing_request()));
  CHECK_TEXT(air.path.has_value(), air.reason().c_str());
  std::vector<path::ForceSample> samples;
  for (const sim::PressStep& step :
       sim::press_along(test::program_of(*air.path), facts, {}, k_force_register).steps) {
    for (const path::Waypoint& w : air.path->path().waypoints) {
      if (w.segment != path::Segment::Line || (w.T_base_tcp.translation() - step.tip_base).norm() > 0.2)
        continue;
      const Mat3 R = w.T_base_tcp.linear().transpose();
      samples.push_back({w.round_ratio, R * step.told_newton, R * w.press_base});
    }
  }
  CHECK(samples.size() > 100);
  path::PlanRequest taught = pressing_request();
  taught.process.force_learned = path::ForceLearned{.set_newton = k_set_newton};
  path::learn_air(*taught.process.force_learned, samples);
  const path::PlanOutcome planned = path::plan(taught);
  CHECK_TEXT(planned.path.has_value(), planned.reason().c_str());
  const auto wall = [](double) { return 0.0; };
  const double alone = off_newton(run_on(wall, facts));
  const double learned = off_newton(run_on(wall, facts, *planned.path));
  CHECK(alone > 1);
  CHECK(learned < 0.6 * alone);
}

TEST(ForceScript, PathInTheAirHasNoForceMode) {
  const path::PlanOutcome air = path::plan(path::force_air_run(pressing_request()));
  CHECK(air.path.has_value());
  CHECK(urscript(*air.path).find("force_mode") == std::string::npos);
  CHECK(urscript(pressing()).find("force_mode") != std::string::npos);
}

TEST(ForceScript, ArmWithoutAForceSensorIsRefused) {
  path::PlanRequest asked = pressing_request();
  asked.arm.name = "UR5";
  const path::PlanOutcome outcome = path::plan(asked);
  CHECK_FALSE(outcome.path.has_value());
  STRCMP_CONTAINS("no force sensor", outcome.reason().c_str());
}

/// Nothing but the direction is turned along the way.
TEST(ForceScript, ForceAlongTheWayIsRefused) {
  path::PlannedPath path = pressing().path();
  for (const path::Check& check : path::force_checks(path)) CHECK_TEXT(check.passed, check.name.c_str());
  for (std::size_t i = 0; i + 1 < path.waypoints.size(); ++i) {
    path::Waypoint& w = path.waypoints[i];
    if (w.segment == path::Segment::Line)
      w.press_base =
          (path.waypoints[i + 1].T_base_tcp.translation() - w.T_base_tcp.translation()).normalized();
  }
  CHECK_FALSE(path::force_checks(path).front().passed);
}

}  // namespace biteline::robot::ur
