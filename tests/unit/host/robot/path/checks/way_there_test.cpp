// SPDX-License-Identifier: MIT
#include "host/robot/path/checks/way_there.hpp"

#include <CppUTest/TestHarness.h>

#include <cfenv>
#include <limits>

#include <cmath>
#include <filesystem>

#include "host/robot/kinematics/chain.hpp"
#include "host/robot/path/plan.hpp"
#include "tests/unit/host/robot/path/made_line.hpp"

namespace biteline::path {

TEST_GROUP(WayThere) {
  PlanRequest request{
      .line = test::made_line({.half_length_mm = 85, .half_width_mm = 40, .middle = {450, 0, 60}}),
      .process = *read_process(std::filesystem::path{BITELINE_PROCESSES} / "grind.yaml"),
      .arm = *kinematics::arm_model("UR5e"),
      .T_line_base = SE3::Identity(),
      .table_z_mm = 20,
      .shoe = {.height_mm = 40},
      .cloud = {}};
  PlanOutcome planned;

  void setup() override {
    planned = plan(request);
    CHECK_TEXT(planned.path.has_value(), planned.reason().c_str());
  }
  CollisionModel collisions() const {
    return {request.arm, request.process.tool, planned.surroundings};
  }
  kinematics::Joints first() const {
    return planned.path->path().waypoints.front().q_rad;
  }
  /// Where it stands, a screen from the table to above the arm is between it and the path.
  kinematics::Joints behind_screen() const {
    kinematics::Joints from = first();
    from[0] += 2.8;
    return from;
  }
  std::vector<Vec3> screen() const {
    const Vec3 tool_base = kinematics::forward(request.arm, first()).translation();
    const double bearing_rad = std::atan2(tool_base.y(), tool_base.x()) + 1.4;
    std::vector<Vec3> points;
    for (double radius_mm = 250; radius_mm <= 1200; radius_mm += 10) {
      for (double z_mm = 20; z_mm <= 1500; z_mm += 10) {
        points.emplace_back(radius_mm * std::cos(bearing_rad), radius_mm * std::sin(bearing_rad), z_mm);
      }
    }
    return points;
  }
  double least_mm(const std::vector<kinematics::Joints>& stops) const {
    double least = 1e9;
    for (std::size_t leg = 0; leg + 1 < stops.size(); ++leg) {
      for (int i = 0; i <= 1000; ++i) {
        const kinematics::Joints q = stops[leg] + (stops[leg + 1] - stops[leg]) * (i / 1000.0);
        least = std::min(least, collisions().clearance(kinematics::joint_frames(request.arm, q), 50).mm);
      }
    }
    return least;
  }
};

TEST(WayThere, AFreeWayIsDirect) {
  kinematics::Joints from = first();
  from[1] -= 0.2;
  const WayThere sut = find_way_there(from, *planned.path, request.arm, collisions());
  CHECK_TEXT(sut.check.passed, sut.check.detail.c_str());
  CHECK(sut.path.has_value());
  LONGS_EQUAL(0, sut.path->path().via_rad.size());
}

TEST(WayThere, AnArmBesideTheShoeGoesOverIt) {
  // At the path's other side, down at the line; the direct way leads through a post.
  const auto& waypoints = planned.path->path().waypoints;
  std::size_t other = 0;
  for (std::size_t i = 0; i < waypoints.size(); ++i) {
    const auto away = [&](std::size_t k) {
      return (waypoints[k].T_base_tcp.translation() - waypoints.front().T_base_tcp.translation()).norm();
    };
    if (waypoints[i].segment == Segment::Line && away(i) > away(other)) other = i;
  }
  const kinematics::Joints from = waypoints[other].q_rad;
  const Vec3 half_way = kinematics::forward(request.arm, (from + first()) / 2) *
                        request.process.tool.T_flange_tcp.translation();
  for (double z_mm = 20; z_mm < half_way.z() + 90; z_mm += 5)
    planned.surroundings.shoe_points.emplace_back(half_way.x(), half_way.y(), z_mm);
  const WayThere sut = find_way_there(from, *planned.path, request.arm, collisions());
  CHECK_TEXT(sut.check.passed, sut.check.detail.c_str());
  std::vector<kinematics::Joints> stops{from};
  for (const auto& via : sut.path->path().via_rad) stops.push_back(via);
  stops.push_back(first());
  // It leaves from the line, where the tool is as near as the work needs; nearer it does not come.
  CHECK(least_mm(stops) >
        std::min(5.0, collisions().clearance(kinematics::joint_frames(request.arm, from), 50).mm) - 1);
  CHECK(least_mm({from, first()}) < 5);
  CHECK(!sut.path->path().via_rad.empty());
}

TEST(WayThere, IsFasterOnlyWhereNothingGoesFasterThanBetweenPlaces) {
  const Motion& motion = request.process.motion;
  const Vec3 tip_flange = request.process.tool.T_flange_tcp.translation();
  double slowest_rad_s = 1e9, fastest_rad_s = 0;
  for (const auto& [joint, by_rad] : {std::pair{5, 0.6}, {4, 0.3}, {3, -0.2}, {0, 0.3}}) {
    kinematics::Joints from = first();
    from[joint] += by_rad;
    const WayThere sut = find_way_there(from, *planned.path, request.arm, collisions());
    CHECK_TEXT(sut.check.passed, sut.check.detail.c_str());
    const double rad_s = sut.path->path().way_there_rad_s.value_or(0);
    slowest_rad_s = std::min(slowest_rad_s, rad_s);
    fastest_rad_s = std::max(fastest_rad_s, rad_s);
    CHECK(rad_s >= motion.way_there_rad_s && rad_s <= k_most_way_ratio * motion.way_there_rad_s);
    if (rad_s <= motion.way_there_rad_s || !sut.path->path().via_rad.empty()) continue;
    constexpr int k_steps = 200;
    for (int i = 0; i < k_steps; ++i) {
      const auto at = [&](int step) -> Vec3 {
        const kinematics::Joints q = from + (first() - from) * (static_cast<double>(step) / k_steps);
        return kinematics::forward(request.arm, q) * tip_flange;
      };
      const double step_s = std::abs(by_rad) / k_steps / rad_s;
      CHECK((at(i + 1) - at(i)).norm() / step_s <= 1.01 * motion.transfer_speed_mm_s);
    }
  }
  // Turned about its axis the tool goes nowhere; the base takes it far round.
  DOUBLES_EQUAL(k_most_way_ratio * motion.way_there_rad_s, fastest_rad_s, 1e-9);
  CHECK(slowest_rad_s < 1.2 * motion.way_there_rad_s);
}

TEST(WayThere, DoesNotSweepTheTipThroughTheUpper) {
  // Over the shoe's middle, as low as the tip's part of the tool only: a wall stands between.
  kinematics::Joints from = first();
  from[0] += 0.25;
  const Vec3 half_way = kinematics::forward(request.arm, (from + first()) / 2) *
                        request.process.tool.T_flange_tcp.translation();
  planned.surroundings.shoe_points.emplace_back(half_way);
  const CollisionModel sut = collisions();
  const auto middle = kinematics::joint_frames(request.arm, (from + first()) / 2);
  CHECK(sut.clearance(middle, 50).mm > 5);
  CHECK(sut.tip_clearance(middle.back(), 50).mm < 0);
  const WayThere way = find_way_there(from, *planned.path, request.arm, sut);
  CHECK(!way.path || !way.path->path().via_rad.empty());
}

TEST(WayThere, WithoutAFreeWayThereIsNone) {
  Surroundings screened = planned.surroundings;
  for (const Vec3& p : screen()) screened.shoe_points.push_back(p);
  const WayThere sut = find_way_there(behind_screen(), *planned.path, request.arm,
                                      CollisionModel{request.arm, request.process.tool, screened});
  CHECK_FALSE(sut.check.passed);
  CHECK_FALSE(sut.path.has_value());
  STRCMP_CONTAINS("from where the arm stands", sut.check.detail.c_str());
}

TEST(WayThere, FromNowhereThereIsNone) {
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 1e300, 100.0}) {
    for (int joint = 0; joint < 6; ++joint) {
      kinematics::Joints from = behind_screen();
      from[joint] = bad;
      const WayThere sut = find_way_there(from, *planned.path, request.arm, collisions());
      CHECK_FALSE(sut.path.has_value());
      CHECK_FALSE(sut.check.passed);
      STRCMP_CONTAINS("is not known", sut.check.detail.c_str());
    }
  }
  std::feclearexcept(FE_ALL_EXCEPT);  // raised on purpose
}

TEST(WayThere, APlanFromWhereTheArmStandsHasItsWayOrIsRefused) {
  request.from_rad = behind_screen();
  const PlanOutcome free = plan(request);
  CHECK_TEXT(free.path.has_value(), free.reason().c_str());
  STRCMP_EQUAL("way there", free.checks.back().name.c_str());

  for (const Vec3& p : planned.surroundings.shoe_points) request.cloud.push_back(p.cast<float>());
  for (const cloud::LinePoint& p : request.line.points) request.cloud.push_back(p.position.cast<float>());
  for (const Vec3& p : screen()) request.cloud.push_back(p.cast<float>());
  const PlanOutcome screened = plan(request);
  CHECK_FALSE(screened.path.has_value());
  CHECK(screened.refusal->code == Refused::NoFreeWayToBegin);
  STRCMP_CONTAINS("from where the arm stands", screened.reason().c_str());
}

}  // namespace biteline::path
