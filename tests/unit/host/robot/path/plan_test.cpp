// SPDX-License-Identifier: MIT
#include "host/robot/path/plan.hpp"

#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <cfenv>
#include <limits>
#include <numbers>

#include "host/robot/kinematics/chain.hpp"
#include "tests/support/refusals.hpp"
#include "tests/support/transforms.hpp"
#include "tests/unit/host/robot/path/made_line.hpp"

namespace biteline::path {
namespace {

PlanRequest request(const char* robot, const char* process) {
  return {.line = test::made_line(),
          .process = *read_process(std::filesystem::path{BITELINE_PROCESSES} / process),
          .arm = *kinematics::arm_model(robot),
          .T_line_base = SE3::Identity(),
          .table_z_mm = 40,
          .shoe = {},
          .cloud = {}};
}

std::string failed(const std::vector<Check>& checks) {
  std::string names;
  for (const Check& check : checks) {
    if (!check.passed) names += check.name + ";";
  }
  return names;
}

}  // namespace

TEST_GROUP(Plan){};

TEST(Plan, EveryShippedProcessIsFollowedByTheUr5eWithEveryCheckPassed) {
  for (const char* name :
       {"grind.yaml", "grind_force.yaml", "rough.yaml", "rough_force.yaml", "cement.yaml", "spray.yaml"}) {
    const PlanRequest asked = request("UR5e", name);
    const PlanOutcome outcome = plan(asked);
    CHECK_TEXT(outcome.path.has_value(), outcome.reason().c_str());
    CHECK_TEXT(failed(outcome.checks).empty(), name);
    for (const Waypoint& w : outcome.path->path().waypoints) {
      TRANSFORMS_EQUAL(w.T_base_tcp,
                       kinematics::forward(asked.arm, w.q_rad) * asked.process.tool.T_flange_tcp, 1e-3, 1e-5);
    }
  }
}

/// The finer spacing that a process may ask for does not go with the least blend: fewer points, and where
/// these leave the line too far, no path.
TEST(Plan, SpacingGrowsForTheBlendsWithinTheChordErrorElseThePlanIsRefused) {
  PlanRequest asked = request("UR5e", "grind.yaml");
  asked.process.motion.spacing_mm = 0.5;
  const PlanOutcome fine = plan(asked);
  CHECK_TEXT(fine.path.has_value(), fine.reason().c_str());
  const auto& waypoints = fine.path->path().waypoints;
  CHECK(waypoints.size() < 400);
  for (std::size_t i = 0; i + 1 < waypoints.size(); ++i) {
    if (waypoints[i].segment != Segment::Line || waypoints[i + 1].segment != Segment::Line) continue;
    const double step_mm =
        (waypoints[i + 1].T_base_tcp.translation() - waypoints[i].T_base_tcp.translation()).norm();
    CHECK(step_mm > 2.04 && step_mm < 2.2);
  }

  asked.process.motion.blend_mm = 3;
  asked.process.motion.chord_error_mm = 0.02;
  const PlanOutcome refused = plan(asked);
  CHECK_FALSE(refused.path.has_value());
  STRCMP_CONTAINS("straight moves", refused.reason().c_str());
  STRCMP_CONTAINS("6.12 mm apart", refused.reason().c_str());
}

TEST(Plan, LineIsJudgedBeforeAnythingIsLaidOverIt) {
  // A grid of 8 mm over these would take hours and all memory.
  for (const double far_mm : {1e7, 1e9, 1e12, 1e300}) {
    PlanRequest asked = request("UR5e", "grind.yaml");
    asked.line.points[95].position.y() = far_mm;
    const PlanOutcome outcome = plan(asked);
    CHECK_FALSE(outcome.path.has_value());
    CHECK(outcome.surroundings.shoe_points.empty());
  }
  PlanRequest asked = request("UR5e", "grind.yaml");
  asked.line.points[95].position.y() = 9.9e4;
  CHECK_FALSE(plan(asked).path.has_value());
}

TEST(Plan, TableFarBelowCostsNoMemory) {
  for (const double table_z_mm : {-1e5, -1e308, -std::numeric_limits<double>::infinity()}) {
    const Surroundings sut = surroundings_of_line(test::made_line(), {}, table_z_mm);
    CHECK(sut.shoe_points.size() < 50'000);
  }
}

TEST(Plan, LineOfAnotherScanIsRefused) {
  PlanRequest asked = request("UR5e", "grind.yaml");
  for (const cloud::LinePoint& p : asked.line.points) {
    for (float z = -20; z < 40; z += 1) asked.cloud.push_back((p.position + z * Vec3::UnitZ()).cast<float>());
  }
  CHECK_TEXT(plan(asked).path.has_value(), plan(asked).reason().c_str());
  for (cloud::LinePoint& p : asked.line.points) p.position.x() += 10;
  const PlanOutcome outcome = plan(asked);
  CHECK_FALSE(outcome.path.has_value());
  STRCMP_CONTAINS("on the cloud: the line leaves the surface", outcome.reason().c_str());
}

TEST(Plan, FreeTurnStaysWithinTheToolsFreedom) {
  const PlanRequest asked = request("UR5e", "cement.yaml");
  const PlanOutcome outcome = plan(asked);
  CHECK(outcome.path.has_value());
  for (std::size_t i = 0; i < outcome.tool_path.points.size(); ++i) {
    const SE3 turn =
        outcome.tool_path.points[i].T_base_tcp.inverse() * outcome.path->path().waypoints[i].T_base_tcp;
    const double turn_rad = geometry::log_so3(turn.linear()).z();
    CHECK(std::abs(turn_rad) <= asked.process.tool.free_turn_rad + 1e-6);
  }
}

TEST(Plan, PathBeginsNearToWhereTheArmStands) {
  PlanRequest asked = request("UR5e", "spray.yaml");
  const PlanOutcome anywhere = plan(asked);
  CHECK(anywhere.path.has_value());
  const auto way_rad = [&](const PlanOutcome& outcome) {
    return (outcome.path->path().waypoints.front().q_rad - *asked.near_rad).cwiseAbs().maxCoeff();
  };
  // The wrist a turn less a little farther than it would be by itself, as a scan leaves it.
  kinematics::Joints stands_rad = anywhere.path->path().waypoints.front().q_rad;
  stands_rad[5] += stands_rad[5] > 0 ? -4.5 : 4.5;
  asked.near_rad = stands_rad;
  const PlanOutcome sut = plan(asked);
  CHECK_TEXT(sut.path.has_value(), sut.reason().c_str());
  CHECK(way_rad(anywhere) > 4);
  CHECK(way_rad(sut) < 1);
}

/// A wrist that a scan left near its limit is not turned back as a whole before the path begins.
TEST(Plan, PathBeginsWithTheTurnsThatTheWristHas) {
  PlanRequest asked = request("UR5e", "grind.yaml");
  const PlanOutcome anywhere = plan(asked);
  CHECK(anywhere.path.has_value());
  for (const double wrist_rad : {-6.2, -5.5, -4.0, -2.0, 0.0, 2.0, 4.0, 5.5, 6.2}) {
    kinematics::Joints stands_rad = anywhere.path->path().waypoints.front().q_rad;
    stands_rad[5] = wrist_rad;
    asked.near_rad = stands_rad;
    const PlanOutcome sut = plan(asked);
    CHECK_TEXT(sut.path.has_value(), sut.reason().c_str());
    CHECK((sut.path->path().waypoints.front().q_rad - stands_rad).cwiseAbs().maxCoeff() < 1.5);
  }
}

TEST(Plan, ShoeOutOfReachIsRefusedWithAMoveThatHelps) {
  PlanRequest asked = request("UR5e", "grind.yaml");
  const Vec3 away{200, 50, 0};
  for (cloud::LinePoint& p : asked.line.points) p.position += away;
  const PlanOutcome outcome = plan(asked);
  CHECK_FALSE(outcome.path.has_value());
  CHECK(outcome.blockage.what == Obstacle::Reach);
  CHECK(outcome.remedy.move_shoe_base.has_value());
  for (cloud::LinePoint& p : asked.line.points) p.position += *outcome.remedy.move_shoe_base;
  CHECK(plan(asked).path.has_value());
}

TEST(Plan, BaseElsewhereIsTheSameAsShoeElsewhere) {
  PlanRequest asked = request("UR5e", "grind.yaml");
  const SE3 T_line_base =
      geometry::make_se3(Eigen::Quaterniond{Eigen::AngleAxisd{2.0, Vec3::UnitZ()}}, Vec3{200, 900, 30});
  const PlanOutcome here = plan(asked);
  for (cloud::LinePoint& p : asked.line.points) {
    p.position = T_line_base * p.position;
    p.normal = T_line_base.linear() * p.normal;
    p.tangent = T_line_base.linear() * p.tangent;
  }
  asked.T_line_base = T_line_base;
  asked.table_z_mm += 30;
  const PlanOutcome there = plan(asked);
  CHECK(here.path && there.path);
  const auto& a = here.path->path().waypoints;
  const auto& b = there.path->path().waypoints;
  CHECK_EQUAL(a.size(), b.size());
  // The tip and the tool's axis; the free turn about it may be another where two cost the same.
  for (std::size_t i = 0; i < a.size(); i += 25) {
    DOUBLES_EQUAL(0.0, (a[i].T_base_tcp.translation() - b[i].T_base_tcp.translation()).norm(), 1e-5);
    DOUBLES_EQUAL(0.0, (a[i].T_base_tcp.linear().col(2) - b[i].T_base_tcp.linear().col(2)).norm(), 1e-7);
  }
}

TEST(Plan, OpenLineIsRefusedBeforeAnythingElse) {
  PlanRequest asked = request("UR5e", "grind.yaml");
  asked.line.points.resize(300);
  const PlanOutcome outcome = plan(asked);
  CHECK_FALSE(outcome.path.has_value());
  CHECK(outcome.refusal->code == Refused::LineUnfit);
  STRCMP_CONTAINS("closed", outcome.reason().c_str());
}

TEST(Plan, EveryRefusalHasItsRow) {
  biteline::test::check_refusal_table(Refused::NotAsTaught);
}

TEST_GROUP(CheckPath) {
  PlanRequest asked = request("UR5e", "grind.yaml");
  PlanOutcome outcome = plan(asked);
  PlannedPath path = outcome.path->path();
  CollisionModel collisions{asked.arm, asked.process.tool,
                            surroundings_of_line(asked.line, asked.shoe, asked.table_z_mm)};

  std::string failed_checks() {
    return failed(check_path(path, asked.arm, collisions, {}).checks);
  }
};

TEST(CheckPath, PlannedPathPassesAgain) {
  STRCMP_EQUAL("", failed_checks().c_str());
}

TEST(CheckPath, WhatIsNoNumberPassesNoCheck) {
  constexpr double k_nan = std::numeric_limits<double>::quiet_NaN();
  const PlannedPath good = path;
  const std::size_t middle = path.waypoints.size() / 2;
  const auto spoiled = [&](auto&& spoil) {
    path = good;
    spoil(path.waypoints[middle]);
    return failed_checks();
  };
  CHECK(spoiled([](Waypoint& w) { w.time_s = k_nan; }).find("time runs forward") != std::string::npos);
  CHECK(spoiled([](Waypoint& w) { w.q_rad[3] = k_nan; }).find("joint limits") != std::string::npos);
  CHECK(spoiled([](Waypoint& w) { w.speed_mm_s = k_nan; }).find("no dwelling") != std::string::npos);
  CHECK(spoiled([](Waypoint& w) { w.T_base_tcp.translation().z() = k_nan; }).find("tip above the table") !=
        std::string::npos);
  path = good;
  for (const double table_z_mm : {k_nan, std::numeric_limits<double>::infinity()}) {
    Surroundings unknown = collisions.surroundings();
    unknown.table_z_mm = table_z_mm;
    const CheckOutcome checked =
        check_path(path, asked.arm, CollisionModel{asked.arm, asked.process.tool, unknown}, {});
    CHECK(failed(checked.checks).find("clearance") != std::string::npos);
    CHECK(failed(checked.checks).find("tip above the table") != std::string::npos);
    CHECK_FALSE(checked.path.has_value());
  }
  std::feclearexcept(FE_ALL_EXCEPT);  // raised on purpose
}

TEST(CheckPath, TipIsNeverInTheTableHoweverLongItsContact) {
  Surroundings raised = collisions.surroundings();
  double lowest_mm = 1e9;
  for (const Waypoint& w : path.waypoints) lowest_mm = std::min(lowest_mm, w.T_base_tcp.translation().z());
  Tool all_contact = asked.process.tool;
  all_contact.contact_length_mm = 300;
  for (const double above_mm : {-30.0, -0.5, 0.5, 3.0}) {
    raised.table_z_mm = lowest_mm - above_mm;
    const CheckOutcome checked =
        check_path(path, asked.arm, CollisionModel{asked.arm, all_contact, raised}, {});
    LONGS_EQUAL(above_mm < 1, failed(checked.checks).find("tip above the table") != std::string::npos);
  }
}

TEST(CheckPath, EveryTamperedPathIsCaught) {
  const PlannedPath good = path;
  const std::size_t middle = path.waypoints.size() / 2;

  path.waypoints[middle].T_base_tcp.translation().x() += 0.1;
  CHECK(failed_checks().find("joints reach the poses") != std::string::npos);

  path = good;
  for (Waypoint& w : path.waypoints) w.q_rad[5] += 4 * std::numbers::pi;
  STRCMP_EQUAL("joint limits;", failed_checks().c_str());

  path = good;
  for (std::size_t i = middle; i < path.waypoints.size(); ++i)
    path.waypoints[i].q_rad[5] -= 2 * std::numbers::pi;
  CHECK(failed_checks().find("no wrist jump") != std::string::npos);

  path = good;
  for (Waypoint& w : path.waypoints) w.time_s *= 0.5;
  CHECK(failed_checks().find("speed") != std::string::npos);

  path = good;
  for (std::size_t i = middle; i < path.waypoints.size(); ++i) path.waypoints[i].time_s -= 1;
  CHECK(failed_checks().find("time runs forward") != std::string::npos);

  path = good;
  path.waypoints.erase(path.waypoints.begin() + static_cast<std::ptrdiff_t>(middle),
                       path.waypoints.begin() + static_cast<std::ptrdiff_t>(middle) + 4);
  CHECK(failed_checks().find("path spacing") != std::string::npos);

  // Two targets 0.3 mm nearer to each other: 1 mm round both no longer fits.
  path = good;
  const Vec3 step =
      path.waypoints[middle + 1].T_base_tcp.translation() - path.waypoints[middle].T_base_tcp.translation();
  path.waypoints[middle].T_base_tcp.translation() += 0.3 * step.normalized();
  CHECK(failed_checks().find("blends apart") != std::string::npos);

  for (const std::size_t end : {std::size_t{0}, path.waypoints.size() - 1}) {
    path = good;
    path.waypoints[end].speed_mm_s = 1;
    STRCMP_EQUAL("rest at the ends;", failed_checks().c_str());
  }
  path = good;
  std::ranges::find_if(path.waypoints, [](const Waypoint& w) {
    return w.segment == Segment::Line;
  })->speed_mm_s = 1;
  STRCMP_EQUAL("rest at the ends;", failed_checks().c_str());

  path = good;
  path.via_rad.resize(1001 - path.waypoints.size(), path.waypoints[0].q_rad);
  STRCMP_EQUAL("program size;", failed_checks().c_str());

  path = good;
  Surroundings wall = collisions.surroundings();
  wall.shoe_points.push_back(path.waypoints[middle].T_base_tcp * Vec3{0, 0, -100});
  const CollisionModel blocked{asked.arm, asked.process.tool, wall};
  const CheckOutcome checked = check_path(path, asked.arm, blocked, {});
  STRCMP_EQUAL("clearance;", failed(checked.checks).c_str());
  CHECK_FALSE(checked.path.has_value());
}

}  // namespace biteline::path
