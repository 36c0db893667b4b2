// SPDX-License-Identifier: MIT
#include "host/robot/path/entry.hpp"

#include <CppUTest/TestHarness.h>

#include <filesystem>

#include "host/robot/kinematics/chain.hpp"
#include "host/robot/kinematics/inverse.hpp"
#include "host/robot/path/checks/way_there.hpp"
#include "host/robot/path/plan.hpp"
#include "tests/unit/host/robot/path/made_line.hpp"

namespace biteline::path {

TEST_GROUP(Entry) {
  PlanRequest request{.line = test::made_line(),
                      .process = *read_process(std::filesystem::path{BITELINE_PROCESSES} / "grind.yaml"),
                      .arm = *kinematics::arm_model("UR10e"),
                      .T_line_base = SE3::Identity(),
                      .table_z_mm = 40,
                      .shoe = {},
                      .cloud = {}};

  void setup() override {
    // A wall round the shoe, which no other points are added to.
    for (const cloud::LinePoint& p : request.line.points) {
      for (float z_mm = -20; z_mm < 40; z_mm += 2)
        request.cloud.push_back((p.position + z_mm * Vec3::UnitZ()).cast<float>());
    }
  }
  std::vector<Seam> seams() const {
    return seam_candidates(request.line, request.process);
  }
  /// As a scan might leave the arm.
  kinematics::Joints with_tip_at(const SE3& T_base_tcp) const {
    const auto solutions = kinematics::inverse(
        request.arm, T_base_tcp * request.process.tool.T_flange_tcp.inverse(), {.q6_hint_rad = 0});
    CHECK(solutions.begin() != solutions.end());
    return solutions.begin()->q_rad;
  }
  /// Beside where the seam's path begins, forwards along the line.
  kinematics::Joints beside(const Seam& seam, double by_mm) const {
    return with_tip_at(seam.T_base_begins * Eigen::Translation3d{by_mm, 0, 0});
  }
};

TEST(Entry, IsOnTheSideOfTheShoeWhereTheArmStands) {
  const std::vector<Seam> harmless = seams();
  // The oval's two sides are alike.
  CHECK(std::abs(harmless[0].harm - harmless[1].harm) < 0.05);
  CHECK(harmless[2].harm > harmless[0].harm + 0.2);
  for (const std::size_t side : {0U, 1U}) {
    const std::vector<Seam> sut =
        seams_in_order(request.line, request.process, request.arm, with_tip_at(harmless[side].T_base_begins));
    DOUBLES_EQUAL(harmless[side].arc_mm, sut.front().arc_mm, 1e-9);
    LONGS_EQUAL(harmless.size(), sut.size());
  }
  DOUBLES_EQUAL(harmless[0].arc_mm,
                seams_in_order(request.line, request.process, request.arm, {}).front().arc_mm, 1e-9);
}

TEST(Entry, TheLeastHarmIsNotGivenUpForAShortWay) {
  const std::vector<Seam> harmless = seams();
  const Seam& worst = harmless.back();
  const std::vector<Seam> sut =
      seams_in_order(request.line, request.process, request.arm, with_tip_at(worst.T_base_begins));
  CHECK(std::abs(sut.front().arc_mm - worst.arc_mm) > 1);
}

TEST(Entry, BeginsFartherBackWhereTheStraightWayWouldTouch) {
  const Seam seam = seams().front();
  request.from_rad = beside(seam, 150);
  const PlanOutcome free = plan(request);
  CHECK_TEXT(free.path.has_value(), free.reason().c_str());
  const auto tip = [&](const kinematics::Joints& q_rad) -> Vec3 {
    return kinematics::forward(request.arm, q_rad) * request.process.tool.T_flange_tcp.translation();
  };
  const Vec3 begins = tip(free.path->path().waypoints.front().q_rad);
  DOUBLES_EQUAL(0, (begins - seam.T_base_begins.translation()).norm(), 0.01);

  // A pin that only the tip of the straight way meets.
  const Vec3 half_way = tip((*request.from_rad + free.path->path().waypoints.front().q_rad) / 2);
  for (int i = 0; i < 5; ++i) request.cloud.push_back((half_way - 2 * i * Vec3::UnitZ()).cast<float>());
  const PlanOutcome sut = plan(request);
  CHECK_TEXT(sut.path.has_value(), sut.reason().c_str());
  CHECK(sut.path->path().via_rad.empty());
  const Vec3 back = tip(sut.path->path().waypoints.front().q_rad) - begins;
  CHECK(back.norm() > 10);
  DOUBLES_EQUAL(-back.norm(), back.dot(seam.T_base_begins.linear().col(2)), 0.01);
  const CollisionModel collisions{request.arm, request.process.tool, sut.surroundings};
  CHECK(!is_free_way(*request.from_rad, free.path->path().waypoints.front().q_rad, request.arm, collisions));
}

}  // namespace biteline::path
