// SPDX-License-Identifier: MIT
#include "host/robot/path/purge.hpp"

#include <CppUTest/TestHarness.h>

#include "host/robot/kinematics/chain.hpp"
#include "host/robot/path/plan.hpp"
#include "tests/unit/host/robot/path/made_line.hpp"

namespace biteline::path {

TEST_GROUP(Purge) {
  PlanRequest request{.line = test::made_line(),
                      .process = *read_process(std::filesystem::path{BITELINE_PROCESSES} / "spray.yaml"),
                      .arm = *kinematics::arm_model("UR5e"),
                      .T_line_base = SE3::Identity(),
                      .table_z_mm = 40,
                      .shoe = {},
                      .cloud = {}};

  PlanOutcome planned(const Vec3& at) {
    request.process.flow = Flow{.purge_s = 0.3, .purge_at_base = at};
    request.seek_remedy = false;
    return plan(request);
  }
};

TEST(Purge, TheToolStandsThereStraightDown) {
  const PlanOutcome outcome = planned({420, 260, 200});
  CHECK_TEXT(outcome.path.has_value(), outcome.reason().c_str());
  const SE3 T =
      kinematics::forward(request.arm, *outcome.path->path().purge_rad) * request.process.tool.T_flange_tcp;
  DOUBLES_EQUAL(0, (T.translation() - Vec3{420, 260, 200}).norm(), 1e-3);
  DOUBLES_EQUAL(-1, T.linear().col(2).z(), 1e-6);
}

TEST(Purge, AboveTheShoeItIsRefused) {
  const PlanOutcome outcome = planned({540, -60, 350});
  CHECK_FALSE(outcome.path.has_value());
  CHECK(outcome.refusal->code == Refused::PathCheckFailed);
  CHECK(outcome.reason().find("falls on the shoe") != std::string::npos);
}

TEST(Purge, ASprayMustStandAsMuchFartherAwayAsItsConeIsWide) {
  request.process.flow = Flow{.purge_s = 0.3, .purge_at_base = {0, 0, 340}};
  const Check narrow = check_purge(request.process, Surroundings{.table_z_mm = 40, .shoe_points = {}});
  request.process.coverage.cone_rad *= 2;
  const Check wide = check_purge(request.process, Surroundings{.table_z_mm = 40, .shoe_points = {}});
  DOUBLES_EQUAL(30 + 300 * std::tan(request.process.coverage.cone_rad / 4), narrow.limit, 1e-9);
  CHECK(wide.limit > narrow.limit + 30);
}

TEST(Purge, OutOfReachItIsRefused) {
  const PlanOutcome outcome = planned({-1500, 900, 200});
  CHECK_FALSE(outcome.path.has_value());
  CHECK(outcome.reason().find("does not reach the place of the purge") != std::string::npos);
}

TEST(Purge, OnTheTableItIsRefused) {
  const PlanOutcome outcome = planned({420, 260, 41});
  CHECK_FALSE(outcome.path.has_value());
  CHECK(outcome.reason().find("too near to the table") != std::string::npos);
}

/// What falls would fall beside the shoe; the tool's body is wider than that.
TEST(Purge, WhereTheToolsBodyWouldTouchTheShoeThereIsNoWay) {
  request.process.tool.body_radius_mm = 45;
  request.from_rad = planned({420, 260, 200}).path->path().waypoints.back().q_rad;
  CHECK(planned({420, 260, 200}).path.has_value());
  const PlanOutcome outcome = planned({540, 37, 85});
  CHECK_FALSE(outcome.path.has_value());
  CHECK_TEXT(outcome.refusal->code == Refused::NoFreeWayToBegin, outcome.reason().c_str());
}

TEST(Purge, OnTheWayThereTheArmComesBy) {
  request.from_rad = planned({420, 260, 200}).path->path().waypoints.back().q_rad;
  const PlanOutcome outcome = planned({420, 260, 200});
  const PlannedPath& path = outcome.path->path();
  CHECK(path.purge_via.has_value());
  DOUBLES_EQUAL(0, (path.via_rad[*path.purge_via] - *path.purge_rad).norm(), 0);
}

TEST(Purge, NothingIsPurgedWithTheToolOff) {
  request.tool_off = true;
  const PlanOutcome outcome = planned({540, -60, 350});
  CHECK_TEXT(outcome.path.has_value(), outcome.reason().c_str());
  CHECK_FALSE(outcome.path->path().purge_rad.has_value());
}

}  // namespace biteline::path
