// SPDX-License-Identifier: MIT
// Pieces of a line that are worked alone, whatever the process works otherwise.
#include <CppUTest/TestHarness.h>

#include <algorithm>

#include "host/robot/path/checks/program_check.hpp"
#include "host/robot/path/plan.hpp"
#include "host/robot/path/zones.hpp"
#include "tests/unit/host/robot/path/made_line.hpp"

namespace biteline::path {

TEST_GROUP(Pieces) {
  PlanRequest request{.line = test::made_line(),
                      .process = *read_process(std::filesystem::path{BITELINE_PROCESSES} / "grind.yaml"),
                      .arm = *kinematics::arm_model("UR5e"),
                      .T_line_base = SE3::Identity(),
                      .table_z_mm = 40,
                      .shoe = {},
                      .cloud = {}};

  /// Along the line from its first point, of a place on it.
  double along_mm(const Vec3& place) const {
    const auto& points = request.line.points;
    double best = 1e9, mm = 0, at_mm = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec3 d = points[(i + 1) % points.size()].position - points[i].position;
      const double share = std::clamp((place - points[i].position).dot(d) / d.squaredNorm(), 0.0, 1.0);
      const double off = (points[i].position + share * d - place).norm();
      if (off < best) best = off, at_mm = mm + share * d.norm();
      mm += d.norm();
    }
    return at_mm;
  }
  struct Run {
    double from_mm, to_mm;
  };
  std::vector<Run> runs(const PlannedPath& path) const {
    std::vector<Run> out;
    for (const PathRun& run : runs_of(path, Segment::Line))
      out.push_back(
          {along_mm(path.waypoints[run.first].line_base), along_mm(path.waypoints[run.last].line_base)});
    return out;
  }
  double farthest_travel_mm(const ToolPath& path) const {
    double mm = 0;
    for (const ToolPoint& p : path.points)
      if (p.segment == Segment::Travel) mm = std::max(mm, (p.T_base_tcp.translation() - p.line_base).norm());
    return mm;
  }
};

TEST(Pieces, EachIsWorkedFromItsBeginningToItsEndAndNothingElse) {
  request.process.only = {{.from_mm = 100.03, .to_mm = 102.61}, {.from_mm = 300, .to_mm = 321.3}};
  const PlanOutcome outcome = plan(request);
  CHECK_TEXT(outcome.path.has_value(), outcome.reason().c_str());
  std::vector<Run> worked = runs(outcome.path->path());
  std::ranges::sort(worked, {}, &Run::from_mm);
  LONGS_EQUAL(2, worked.size());
  for (std::size_t i = 0; i < 2; ++i) {
    DOUBLES_EQUAL(request.process.only[i].from_mm, worked[i].from_mm, 0.06);
    DOUBLES_EQUAL(request.process.only[i].to_mm, worked[i].to_mm, 0.06);
  }
  DOUBLES_EQUAL(0, outcome.path->path().overlap_mm, 0);
}

TEST(Pieces, OneOverTheLinesFirstPointIsOneRun) {
  const double line_mm = cloud::length_mm(request.line);
  request.process.only = {{.from_mm = line_mm - 4, .to_mm = 5}};
  const PlanOutcome outcome = plan(request);
  CHECK_TEXT(outcome.path.has_value(), outcome.reason().c_str());
  const std::vector<Run> worked = runs(outcome.path->path());
  LONGS_EQUAL(1, worked.size());
  DOUBLES_EQUAL(line_mm - 4, worked[0].from_mm, 0.06);
  DOUBLES_EQUAL(5, worked[0].to_mm, 0.06);
}

TEST(Pieces, TheyAreWorkedAsTheProcessWorksThatPlace) {
  request.process.zones = {
      {.name = "toe", .where = Zone::Where::Toe, .reach_ratio = 0.3, .up_by_mm = 2, .speed_ratio = 0.5}};
  request.line = test::made_line({.taper = 0.15});
  Process whole = request.process;
  const ToolPath all = make_tool_path(request.line, whole, 0);
  request.process.only = {{.from_mm = 5, .to_mm = 25}};  // at the toe's end
  const ToolPath piece = make_tool_path(request.line, request.process, 0);
  for (const ToolPoint& p : piece.points) {
    if (p.segment != Segment::Line) continue;
    const ToolPoint& same = *std::ranges::min_element(all.points, {}, [&](const ToolPoint& q) {
      return q.segment == Segment::Line ? (q.line_base - p.line_base).norm() : 1e9;
    });
    // Two samplings of one line, up to 1 mm apart round a toe.
    CHECK((p.T_base_tcp.translation() - p.line_base - same.T_base_tcp.translation() + same.line_base).norm() <
          0.1);
    DOUBLES_EQUAL(same.speed_ratio, p.speed_ratio, 1e-9);
  }
}

TEST(Pieces, AZonesFurtherPassesStayWithinThem) {
  request.line = test::made_line({.taper = 0.15});
  request.process.zones = {{.name = "toe", .where = Zone::Where::Toe, .reach_ratio = 0.3, .passes = 2}};
  request.process.only = {{.from_mm = 5, .to_mm = 25}};
  double line_mm = 0;
  const ToolPath path = make_tool_path(request.line, request.process, 0);
  for (std::size_t i = 1; i < path.points.size(); ++i)
    if (path.points[i].segment == Segment::Line && path.points[i - 1].segment == Segment::Line)
      line_mm += (path.points[i].line_base - path.points[i - 1].line_base).norm();
  DOUBLES_EQUAL(40, line_mm, 0.5);
}

TEST(Pieces, BetweenNearOnesTheToolOnlyDrawsBack) {
  request.process.only = {{.from_mm = 100, .to_mm = 103}, {.from_mm = 120, .to_mm = 123}};
  const double near_mm = farthest_travel_mm(make_tool_path(request.line, request.process, 100));
  request.process.only[1] = {.from_mm = 330, .to_mm = 333};
  const double far_mm = farthest_travel_mm(make_tool_path(request.line, request.process, 100));
  const Motion& motion = request.process.motion;
  const double beside_mm = request.process.placement.up_mm;
  CHECK(near_mm < motion.approach_mm + beside_mm + 1);
  CHECK(far_mm > motion.approach_mm + motion.draw_back_mm);
}

TEST(Pieces, ThePathBeginsBehindTheLongestWayBetween) {
  request.process.only = {
      {.from_mm = 20, .to_mm = 30}, {.from_mm = 400, .to_mm = 410}, {.from_mm = 500, .to_mm = 510}};
  DOUBLES_EQUAL(400, seam_candidates(request.line, request.process)[0].arc_mm, 0.1);
}

TEST(Pieces, WhatTheZonesLeaveOutIsNoPiece) {
  request.line = test::made_line({.taper = 0.15});
  request.process.zones = {{.name = "toe", .where = Zone::Where::Toe, .reach_ratio = 0.3, .left_out = true}};
  request.process.only = {{.from_mm = 5, .to_mm = 25}};
  CHECK_FALSE(all_passed(check_pieces(request.line, request.process)));
  const PlanOutcome outcome = plan(request);
  CHECK_FALSE(outcome.path.has_value());
  CHECK(outcome.refusal->code == Refused::LineUnfit);
}

TEST(Pieces, WithoutAnyNothingIsAskedOfThem) {
  CHECK(check_pieces(request.line, request.process).empty());
}

}  // namespace biteline::path
