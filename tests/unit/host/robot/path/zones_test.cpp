// SPDX-License-Identifier: MIT
#include "host/robot/path/zones.hpp"

#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "hal/sim/shoe/made_shoe.hpp"
#include "hal/sim/shoe/true_line.hpp"
#include "host/robot/path/checks/program_check.hpp"
#include "host/robot/path/plan.hpp"
#include "tests/unit/host/robot/path/made_line.hpp"

namespace biteline::path {
namespace {

const test::Oval k_shoe{.taper = 0.15};  // its toe at +x
constexpr double k_heel_mm = 540 - 135, k_length_mm = 270;

double along_ratio(const Vec3& place) {
  return (place.x() - k_heel_mm) / k_length_mm;
}

std::vector<std::vector<ToolPoint>> line_runs(const ToolPath& path) {
  std::vector<std::vector<ToolPoint>> runs;
  bool before = false;
  for (const ToolPoint& p : path.points) {
    const bool on_line = p.segment == Segment::Line;
    if (on_line && !before) runs.emplace_back();
    if (on_line) runs.back().push_back(p);
    before = on_line;
  }
  return runs;
}

}  // namespace

TEST_GROUP(Zones) {
  cloud::ClosedLine line = test::made_line(k_shoe);
  Process process;

  static Zone left_out(Zone::Where where, double reach_ratio) {
    return {.name = "left out", .where = where, .reach_ratio = reach_ratio, .left_out = true};
  }
  /// Share of the line, from the heel's end anticlockwise, where the middle of zone 0 lies.
  static double middle_ratio(const Process& process) {
    const Zone& zone = process.zones[0];
    return (zone.from_ratio + zone.to_ratio) / 2;
  }
  PlanRequest request() const {
    PlanRequest asked{.line = line,
                      .process = *read_process(std::filesystem::path{BITELINE_PROCESSES} / "grind.yaml"),
                      .arm = *kinematics::arm_model("UR5e"),
                      .T_line_base = SE3::Identity(),
                      .table_z_mm = 40,
                      .shoe = {},
                      .cloud = {}};
    asked.process.zones = process.zones;
    return asked;
  }
};

TEST(Zones, AStretchOfALeftShoeLiesMirroredOnARightOne) {
  process.foot = "left";
  process.zones = {{.name = "inner side", .from_ratio = 0.15, .to_ratio = 0.35}};
  const Process right = on_foot(process, "right");
  DOUBLES_EQUAL(0.65, right.zones[0].from_ratio, 1e-12);
  DOUBLES_EQUAL(0.85, right.zones[0].to_ratio, 1e-12);
  // Told of a right one now: a second time changes nothing.
  DOUBLES_EQUAL(0.75, middle_ratio(on_foot(right, "right")), 1e-12);
  DOUBLES_EQUAL(0.25, middle_ratio(on_foot(right, "left")), 1e-12);
}

TEST(Zones, AStretchOverTheHeelStaysOverTheHeel) {
  process.foot = "right";
  process.zones = {{.name = "heel", .from_ratio = 0.9, .to_ratio = 0.05}};
  const Process left = on_foot(process, "left");
  DOUBLES_EQUAL(0.95, left.zones[0].from_ratio, 1e-12);
  DOUBLES_EQUAL(0.1, left.zones[0].to_ratio, 1e-12);
}

TEST(Zones, WithoutAFootAStretchLiesWhereItIsTold) {
  process.zones = {{.name = "stretch", .from_ratio = 0.15, .to_ratio = 0.35}};
  DOUBLES_EQUAL(0.25, middle_ratio(on_foot(process, "right")), 1e-12);
  CHECK_FALSE(needs_foot(process));
  process.foot = "left";
  DOUBLES_EQUAL(0.25, middle_ratio(on_foot(process, "")), 1e-12);
  CHECK_TRUE(needs_foot(process));
  process.zones[0].where = Zone::Where::Heel;
  CHECK_FALSE(needs_foot(process));
}

TEST(Zones, HeelAndToeAreToldApartHoweverTheShoeLies) {
  for (const double turn_rad : {0.0, 1.0, 2.5, 4.0}) {
    std::vector<Vec3> places;
    const Eigen::AngleAxisd turn{turn_rad, Vec3::UnitZ()};
    for (const cloud::LinePoint& p : line.points) places.emplace_back(turn * p.position);
    const ShoeEnds ends = shoe_ends(places);
    const Vec3 toe = turn * Vec3::UnitX();
    DOUBLES_EQUAL(1.0, ends.heel_to_toe.dot(toe.head<2>()), 1e-4);
    DOUBLES_EQUAL(k_length_mm, ends.toe_mm - ends.heel_mm, 0.1);
  }
}

TEST(Zones, HeelAndToeOfMadeShoesAreToldApart) {
  for (const sim::ShoeClass kind : {sim::ShoeClass::Deep, sim::ShoeClass::Shallow}) {
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      std::vector<Vec3> places;
      for (const sim::TrueLinePoint& p : sim::true_line(sim::MadeShoe{sim::draw_shoe(kind, seed)}, 1.0))
        places.push_back(p.point_shoe);
      const ShoeEnds ends = shoe_ends(places);
      CHECK(ends.heel_to_toe.x() > 0.98);
      CHECK(ends.lead_ratio > 0.01);
    }
  }
}

TEST(Zones, WithoutThemThePathIsTheClosedLine) {
  LONGS_EQUAL(1, line_runs(make_tool_path(line, process, 0)).size());
  CHECK(check_zones(line, process).empty());
}

TEST(Zones, AHeelThatIsLeftOutLeavesOneOpenStretch) {
  process.zones = {left_out(Zone::Where::Heel, 0.2)};
  CHECK(all_passed(check_zones(line, process)));
  const ToolPath path = make_tool_path(line, process, 100);
  const auto runs = line_runs(path);
  LONGS_EQUAL(1, runs.size());
  for (const ToolPoint& p : runs[0]) CHECK(along_ratio(p.line_base) > 0.199);
  // From border to border, nothing twice, within a step of the sampling.
  DOUBLES_EQUAL(0.2, along_ratio(runs[0].front().line_base), 0.005);
  DOUBLES_EQUAL(0.2, along_ratio(runs[0].back().line_base), 0.005);
  // Anticlockwise from the heel: first along the side of smaller y.
  CHECK(runs[0].front().line_base.y() < -60);
  CHECK(runs[0].back().line_base.y() > -60);
  for (const ToolPoint& p : path.points) CHECK(p.segment != Segment::Travel);
}

TEST(Zones, BetweenTwoStretchesTheToolTravelsBesideTheLineAndLifted) {
  process.zones = {left_out(Zone::Where::Heel, 0.2), left_out(Zone::Where::Toe, 0.2)};
  const ToolPath path = make_tool_path(line, process, 0);
  LONGS_EQUAL(2, line_runs(path).size());
  std::size_t travelled = 0;
  for (const ToolPoint& p : path.points) {
    if (p.segment != Segment::Travel) continue;
    ++travelled;
    const Vec3 off = p.T_base_tcp.translation() - p.line_base;
    DOUBLES_EQUAL(process.motion.lift_mm, off.z(), 1.5);
    DOUBLES_EQUAL(process.motion.approach_mm, off.head<2>().norm(), 1.5);
    const double along = along_ratio(p.line_base);
    CHECK(along < 0.21 || along > 0.79);
  }
  CHECK(travelled > 5);
  // In order, without a jump, away from the line in between.
  for (std::size_t i = 1; i < path.points.size(); ++i) {
    const ToolPoint &a = path.points[i - 1], &b = path.points[i];
    const double step_mm = (b.T_base_tcp.translation() - a.T_base_tcp.translation()).norm();
    CHECK(step_mm > 0.5 && step_mm < 21);
    if (a.segment == b.segment) continue;
    CHECK(!(a.segment == Segment::Line && b.segment == Segment::Travel));
    CHECK(!(a.segment == Segment::Travel && b.segment == Segment::Line));
  }
}

TEST(Zones, OffsetsAnglesAndSpeedAreTheZonesOwnWithinItsEnds) {
  // Of the length, anticlockwise from the heel: the side of smaller y.
  process.zones = {{.name = "side",
                    .from_ratio = 0.2,
                    .to_ratio = 0.3,
                    .outward_by_mm = 3,
                    .up_by_mm = 2,
                    .tilt_by_rad = 0.4,
                    .speed_ratio = 0.5,
                    .ramp_mm = 10}};
  const double length_mm = cloud::length_mm(line);
  std::vector<Vec3> places;
  for (const cloud::LinePoint& p : line.points) places.push_back(p.position);
  const auto heel = static_cast<std::size_t>(
      std::ranges::min_element(places, {}, [](const Vec3& p) { return p.x(); }) - places.begin());
  const auto share = [&](const Vec3& at) {
    const auto nearest = static_cast<std::size_t>(
        std::ranges::min_element(places, {}, [&](const Vec3& p) { return (p - at).norm(); }) -
        places.begin());
    return static_cast<double>((nearest + places.size() - heel) % places.size()) /
           static_cast<double>(places.size());
  };
  std::size_t inside = 0, outside = 0;
  const auto runs = line_runs(make_tool_path(line, process, 0));
  LONGS_EQUAL(1, runs.size());
  for (const ToolPoint& p : runs[0]) {
    const double here = share(p.line_base), to_border_mm = std::min(here - 0.2, 0.3 - here) * length_mm;
    const Vec3 x = p.T_base_tcp.linear().col(0), z = p.T_base_tcp.linear().col(2);
    const Vec3 out = x.cross(Vec3::UnitZ()).normalized();
    const Vec3 off = p.T_base_tcp.translation() - p.line_base;
    if (to_border_mm < -2) {
      ++outside;
      DOUBLES_EQUAL(0, off.norm(), 0.01);
      DOUBLES_EQUAL(1, p.speed_ratio, 0);
    } else if (to_border_mm > 12) {
      ++inside;
      DOUBLES_EQUAL(3, off.dot(out), 0.05);
      DOUBLES_EQUAL(2, off.z(), 0.05);
      DOUBLES_EQUAL(-std::sin(0.4), z.z(), 0.02);
      DOUBLES_EQUAL(0.5, p.speed_ratio, 0);
    } else {
      CHECK(off.norm() < std::hypot(3, 2) + 0.05);
    }
  }
  CHECK(inside > 10);
  CHECK(outside > 100);
}

TEST(Zones, ASinglePlaceBetweenTwoThatAreLeftOutIsNoStretch) {
  // Places of the path's own sampling: a quarter of its spacing apart.
  const double count = std::round(4 * cloud::length_mm(line) / process.motion.spacing_mm);
  process.zones = {{.name = "before", .from_ratio = 0, .to_ratio = 99.5 / count, .left_out = true},
                   {.name = "behind", .from_ratio = 100.5 / count, .to_ratio = 0.4, .left_out = true}};
  LONGS_EQUAL(1, line_runs(make_tool_path(line, process, 0)).size());
}

TEST(Zones, FurtherPassesComeBackToTheZoneAlone) {
  process.zones = {{.name = "toe", .where = Zone::Where::Toe, .reach_ratio = 0.3, .passes = 3}};
  const auto runs = line_runs(make_tool_path(line, process, 0));
  LONGS_EQUAL(3, runs.size());
  CHECK(runs[0].size() > 200);
  for (std::size_t i = 1; i < 3; ++i) {
    DOUBLES_EQUAL(0.7, along_ratio(runs[i].front().line_base), 0.005);
    DOUBLES_EQUAL(0.7, along_ratio(runs[i].back().line_base), 0.005);
    for (const ToolPoint& p : runs[i]) CHECK(along_ratio(p.line_base) > 0.695);
  }
}

TEST(Zones, WhereTwoMeetTheFirstCounts) {
  process.zones = {{.name = "all", .where = Zone::Where::Heel, .reach_ratio = 0.5, .speed_ratio = 2},
                   left_out(Zone::Where::Heel, 0.2)};
  const auto runs = line_runs(make_tool_path(line, process, 0));
  LONGS_EQUAL(1, runs.size());
  CHECK(std::ranges::any_of(runs[0], [](const ToolPoint& p) { return along_ratio(p.line_base) < 0.05; }));
}

TEST(Zones, ThePlanPassesEveryCheckAndSwitchesTheToolAtRest) {
  process.zones = {left_out(Zone::Where::Heel, 0.15),
                   {.name = "toe",
                    .where = Zone::Where::Toe,
                    .reach_ratio = 0.2,
                    .up_by_mm = 1,
                    .speed_ratio = 0.5,
                    .passes = 2}};
  const PlanRequest asked = request();
  const PlanOutcome outcome = plan(asked);
  CHECK_TEXT(outcome.path.has_value(), outcome.reason().c_str());
  const PlannedPath& path = outcome.path->path();
  const std::vector<PathRun> runs = runs_of(path, Segment::Line);
  LONGS_EQUAL(2, runs.size());
  LONGS_EQUAL(1, runs_of(path, Segment::Travel).size());
  for (const PathRun& run : rounded_runs(path)) {
    DOUBLES_EQUAL(0, path.waypoints[run.first].speed_mm_s, 0);
    DOUBLES_EQUAL(0, path.waypoints[run.last].speed_mm_s, 0);
  }
  double fastest_toe_mm_s = 0, fastest_mm_s = 0;
  for (std::size_t i = runs[0].first; i <= runs[0].last; ++i) {
    const Waypoint& w = path.waypoints[i];
    double& fastest = along_ratio(w.line_base) > 0.8 ? fastest_toe_mm_s : fastest_mm_s;
    fastest = std::max(fastest, w.speed_mm_s);
  }
  DOUBLES_EQUAL(asked.process.motion.speed_mm_s, fastest_mm_s, 0.1);
  DOUBLES_EQUAL(0.5 * asked.process.motion.speed_mm_s, fastest_toe_mm_s, 0.1);
}

TEST(Zones, AZonesOwnSpeedIsHeldByTheCheck) {
  process.zones = {{.name = "toe", .where = Zone::Where::Toe, .reach_ratio = 0.2, .speed_ratio = 0.5}};
  const PlanRequest asked = request();
  const PlanOutcome outcome = plan(asked);
  CHECK_TEXT(outcome.path.has_value(), outcome.reason().c_str());
  PlannedPath path = outcome.path->path();
  const CollisionModel collisions{asked.arm, asked.process.tool, outcome.surroundings};
  CHECK(check_path(path, asked.arm, collisions, {}).path.has_value());
  // A quarter of it is what the zone now asks for: twice what is planned is too fast.
  for (Waypoint& w : path.waypoints) w.speed_ratio *= 0.5;
  const CheckOutcome checked = check_path(path, asked.arm, collisions, {});
  CHECK_FALSE(checked.path.has_value());
  const auto speed = std::ranges::find_if(checked.checks, [](const Check& c) { return c.name == "speed"; });
  CHECK_FALSE(speed->passed);
}

TEST(Zones, NoShareOfTheSpeedLetsEverySpeedPass) {
  const PlanRequest asked = request();
  const PlanOutcome outcome = plan(asked);
  CHECK_TEXT(outcome.path.has_value(), outcome.reason().c_str());
  PlannedPath path = outcome.path->path();
  const CollisionModel collisions{asked.arm, asked.process.tool, outcome.surroundings};
  for (Waypoint& w : path.waypoints) {
    w.speed_ratio = std::numeric_limits<double>::infinity();
    w.time_s /= 1.2 * k_most_speed_ratio;
  }
  const CheckOutcome checked = check_path(path, asked.arm, collisions, {});
  const auto speed = std::ranges::find_if(checked.checks, [](const Check& c) { return c.name == "speed"; });
  CHECK_FALSE(speed->passed);
}

TEST(Zones, ALineThatDoesNotTellItsHeelIsRefusedForThemAlone) {
  line = test::made_line();
  CHECK(plan(request()).path.has_value());
  process.zones = {left_out(Zone::Where::Heel, 0.2)};
  const PlanOutcome outcome = plan(request());
  CHECK_FALSE(outcome.path.has_value());
  CHECK(outcome.refusal->code == Refused::LineUnfit);
  STRCMP_CONTAINS("heel and toe", outcome.refusal->reason.c_str());
}

TEST(Zones, NothingLeftToWorkAndStretchesTooShortAreRefused) {
  process.zones = {left_out(Zone::Where::Heel, 0.5), left_out(Zone::Where::Toe, 0.5)};
  PlanOutcome outcome = plan(request());
  CHECK(outcome.refusal->code == Refused::LineUnfit);
  STRCMP_CONTAINS("nothing of the line is left", outcome.refusal->reason.c_str());
  process.zones = {left_out(Zone::Where::Heel, 0.5), left_out(Zone::Where::Toe, 0.49)};
  outcome = plan(request());
  STRCMP_CONTAINS("too short", outcome.refusal->reason.c_str());
}

}  // namespace biteline::path
