// SPDX-License-Identifier: MIT
// A program that presses, cycle by cycle in the simulated controller's made time, on a wall of springs.
#include "host/robot/link/ur/force_script.hpp"

#include <CppUTest/TestHarness.h>

#include <cmath>
#include <memory>

#include "hal/sim/robot/press_run.hpp"
#include "host/robot/link/ur/script.hpp"
#include "host/robot/path/checks/force_check.hpp"
#include "host/robot/path/first_run.hpp"
#include "host/robot/path/force.hpp"
#include "host/robot/path/force_learning.hpp"
#include "tests/unit/host/robot/link/planned.hpp"

namespace biteline::robot::ur {
namespace {

constexpr double k_set_newton = 20, k_wall_newton_per_mm = 15;

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

/// Springs where the path's tips are, `deeper_mm` farther in, by the time since the touch.
struct Wall {
  const path::PlannedPath& path;
  std::function<double(double touched_s)> deeper_mm;
  std::size_t near{0};
  double touched_s{0};

  Vec3 operator()(const SE3& T_base_tcp, double step_s) {
    const Vec3 tip = T_base_tcp.translation();
    const auto off = [&](std::size_t i) { return (path.waypoints[i].T_base_tcp.translation() - tip).norm(); };
    for (std::size_t i = 0; i < path.waypoints.size(); ++i) {
      if (path.waypoints[i].segment == path::Segment::Line && off(i) < off(near)) near = i;
    }
    const path::Waypoint& w = path.waypoints[near];
    const double depth_mm = (tip - w.T_base_tcp.translation()).dot(w.press_base) - deeper_mm(touched_s);
    if (depth_mm > 0 || touched_s > 0) touched_s += step_s;
    return -std::max(0.0, depth_mm) * k_wall_newton_per_mm * w.press_base;
  }
};

std::shared_ptr<const sim::Program> program_of(const path::CheckedPath& checked) {
  sim::Script script = *sim::parse_script(urscript(checked));
  const auto arm = sim::ArmKinematics::named("ur5e");
  const sim::JointVector from_rad = checked.path().waypoints.front().q_rad;
  script.start_rad = from_rad;
  return std::make_shared<const sim::Program>(
      sim::Program::plan(script, *arm, arm->T_base_flange(from_rad), SE3::Identity()));
}

sim::PressRun run_on(const std::function<double(double)>& deeper_mm, const sim::ForceFacts& facts = {},
                     const path::CheckedPath& checked = pressing()) {
  Wall wall{.path = checked.path(), .deeper_mm = deeper_mm};
  return sim::press_along(program_of(checked), facts, std::ref(wall), k_force_register);
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

}  // namespace

TEST_GROUP(ForceScript){};

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
       sim::press_along(program_of(*air.path), facts, {}, k_force_register).steps) {
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
