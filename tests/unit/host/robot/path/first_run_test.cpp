// SPDX-License-Identifier: MIT
#include "host/robot/path/first_run.hpp"

#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "host/robot/path/plan.hpp"
#include "tests/unit/host/robot/path/made_line.hpp"

namespace biteline::path {
namespace {

PlanRequest request(const char* process) {
  return {.line = test::made_line(),
          .process = *read_process(std::filesystem::path{BITELINE_PROCESSES} / process),
          .arm = *kinematics::arm_model("UR5e"),
          .T_line_base = SE3::Identity(),
          .table_z_mm = 40,
          .shoe = {},
          .cloud = {}};
}

double mean_height_mm(const PlannedPath& path) {
  double sum = 0, count = 0;
  for (const Waypoint& waypoint : path.waypoints) {
    if (waypoint.segment != Segment::Line) continue;
    sum += waypoint.T_base_tcp.translation().z();
    count += 1;
  }
  return sum / count;
}

}  // namespace

TEST_GROUP(FirstRun){};

TEST(FirstRun, EveryShippedProcessRunsHigherAndTenTimesSlowerWithItsToolOff) {
  for (const char* name : {"grind.yaml", "rough.yaml", "cement.yaml", "spray.yaml"}) {
    PlanRequest asked = request(name);
    asked.process.digital_output = 2;
    const PlanOutcome real = plan(asked);
    CHECK_TEXT(real.path.has_value(), real.reason().c_str());
    const PlanRequest lifted = first_run(asked);
    const PlanOutcome first = plan(lifted);
    CHECK_TEXT(first.path.has_value(), first.reason().c_str());
    DOUBLES_EQUAL(k_first_run_lift_mm, mean_height_mm(first.path->path()) - mean_height_mm(real.path->path()),
                  1.5);
    CHECK(first.path->duration_s() > 8 * real.path->duration_s());
    // Its number stays: what a halted program left on is switched off.
    LONGS_EQUAL(2, first.path->path().digital_output);
    CHECK(first.path->path().tool_off);
    CHECK_FALSE(real.path->path().tool_off);
  }
}

/// Of all ways beside the line, from stop to stop: how much longer the plan takes than a controller, which
/// drives each at the fastest speed planned on it.
double most_ahead_s(const PlannedPath& path) {
  double ahead_s = 0;
  const std::vector<Waypoint>& w = path.waypoints;
  for (std::size_t first = 0; first + 1 < w.size(); ++first) {
    double fastest_mm_s = 0;
    std::size_t last = first + 1;
    for (; last + 1 < w.size() && w[last].speed_mm_s > 0 && w[last].segment != Segment::Line; ++last)
      fastest_mm_s = std::max(fastest_mm_s, w[last].speed_mm_s);
    if (fastest_mm_s > 0)
      ahead_s += w[last].time_s - w[first].time_s - (w[last].arc_mm - w[first].arc_mm) / fastest_mm_s;
    first = last - 1;
  }
  return ahead_s;
}

TEST(FirstRun, NoControllerIsSoFarAheadOnAStraightWayThatFollowingStopsIt) {
  for (const char* name : {"grind.yaml", "rough.yaml", "cement.yaml", "spray.yaml"}) {
    for (const double base_rad : {0.0, 1.2, 2.4, -1.2}) {
      PlanRequest asked = request(name);
      // Other places beside the arm bend its joints otherwise.
      asked.T_line_base = Eigen::AngleAxisd(base_rad, Vec3::UnitZ()) * asked.T_line_base;
      const PlanOutcome first = plan(first_run(asked));
      if (!first.path) continue;
      CHECK_COMPARE(most_ahead_s(first.path->path()), <, asked.process.follow.late_s);
    }
  }
}

/// The upper's wall leans out by so much above the line.
std::vector<Eigen::Vector3f> wall(const cloud::ClosedLine& line, double lean_rad) {
  std::vector<Eigen::Vector3f> points;
  for (const cloud::LinePoint& p : line.points) {
    for (double up_mm = 0; up_mm < 70; up_mm += 1)
      points.push_back(
          (p.position + up_mm * Vec3::UnitZ() + up_mm * std::tan(lean_rad) * p.normal).cast<float>());
  }
  return points;
}

TEST(FirstRun, AWallThatLeansOutIsNotMetOrThereIsNoRun) {
  constexpr double k_rad_per_deg = std::numbers::pi / 180;
  PlanRequest asked = first_run(request("rough.yaml"));
  asked.seek_remedy = false;
  asked.cloud = wall(asked.line, 20 * k_rad_per_deg);
  const PlanOutcome usual = plan(asked);
  CHECK_TEXT(usual.path.has_value(), usual.reason().c_str());
  const auto air = std::ranges::find(usual.checks, "tip in the air", &Check::name);
  CHECK(air != usual.checks.end());
  CHECK(air->value >= k_first_run_clear_mm);
  // Clear of the tool's body, which leans back: only the tip would meet it.
  asked.cloud = wall(asked.line, 32 * k_rad_per_deg);
  const PlanOutcome outcome = plan(asked);
  CHECK(!outcome.path.has_value());
  STRCMP_CONTAINS("tip in the air", outcome.reason().c_str());
  CHECK(outcome.refusal->code == Refused::PathCheckFailed);
  asked.least_tip_to_shoe_mm = 0;
  CHECK_TEXT(plan(asked).path.has_value(), "and nothing else");
}

TEST(FirstRun, NothingBecomesSlowerThanAMillimetreASecondOrThanTheProcess) {
  PlanRequest asked = request("grind.yaml");
  Motion& motion = asked.process.motion;
  motion.minimum_speed_mm_s = 0.1;
  motion.approach_speed_mm_s = 4;
  motion.speed_mm_s = 6;
  asked.process.follow.stall_s = 0.2;
  asked.process.zones = {{.name = "slow", .from_ratio = 0.1, .to_ratio = 0.2, .speed_ratio = 0.1},
                         {.name = "fast", .from_ratio = 0.4, .to_ratio = 0.5, .speed_ratio = 5}};
  const Process slow = first_run(asked).process;
  DOUBLES_EQUAL(1, slow.motion.speed_mm_s, 1e-9);
  DOUBLES_EQUAL(1, slow.motion.approach_speed_mm_s, 1e-9);
  DOUBLES_EQUAL(0.6, slow.zones[0].speed_ratio * slow.motion.speed_mm_s, 1e-9);
  DOUBLES_EQUAL(3, slow.zones[1].speed_ratio * slow.motion.speed_mm_s, 1e-9);
  DOUBLES_EQUAL(FollowLimits{}.stall_s, slow.follow.stall_s, 0);
  // A creep stays what it is.
  motion.speed_mm_s = 0.5;
  asked.process.zones.clear();
  DOUBLES_EQUAL(0.5, first_run(asked).process.motion.speed_mm_s, 1e-9);
}

TEST(FirstRun, WhatGuardsTheArmStays) {
  const PlanRequest asked = request("grind.yaml");
  const Process& real = asked.process;
  const Process first = first_run(asked).process;
  // What the controller drives at one speed is planned at one speed.
  CHECK(first.motion.transfer_speed_mm_s <= k_first_run_speed_ratio * real.motion.transfer_speed_mm_s);
  DOUBLES_EQUAL(first.motion.approach_speed_mm_s, first.motion.transfer_speed_mm_s, 1e-9);
  DOUBLES_EQUAL(k_first_run_speed_ratio * real.motion.way_there_rad_s, first.motion.way_there_rad_s, 1e-9);
  DOUBLES_EQUAL(real.follow.off_path_mm, first.follow.off_path_mm, 0);
  DOUBLES_EQUAL(real.gate.scan_age_s, first.gate.scan_age_s, 0);
  CHECK(real.gate.approval == first.gate.approval);
  DOUBLES_EQUAL(real.tool.body_radius_mm, first.tool.body_radius_mm, 0);
}

}  // namespace biteline::path
