// SPDX-License-Identifier: MIT
#include "host/robot/path/certainty.hpp"

#include <CppUTest/TestHarness.h>

#include "host/robot/path/plan.hpp"
#include "tests/unit/host/robot/path/made_line.hpp"

namespace biteline::path {
namespace {

/// One waypoint a millimetre, the first and last two off the line.
PlannedPath path_of(const std::vector<std::optional<double>>& u95_mm) {
  PlannedPath path;
  const auto add = [&](Segment segment, const std::optional<double>& value) {
    path.waypoints.push_back({.T_base_tcp = SE3::Identity(),
                              .q_rad = kinematics::Joints::Zero(),
                              .segment = segment,
                              .arc_mm = static_cast<double>(path.waypoints.size()),
                              .line_base = Vec3::Zero(),
                              .u95_mm = value});
  };
  add(Segment::Approach, {});
  for (const auto& value : u95_mm) add(Segment::Line, value);
  add(Segment::Retreat, {});
  return path;
}

ToolPath tool_path(const cloud::ClosedLine& line, double standoff_mm) {
  Process process = *read_process(std::filesystem::path{BITELINE_PROCESSES} / "grind.yaml");
  process.placement.standoff_mm = standoff_mm;
  return make_tool_path(line, process, 0);
}

double most_mm(const ToolPath& path) {
  double most = 0;
  for (const ToolPoint& point : path.points) most = std::max(most, point.u95_mm.value_or(0));
  return most;
}

}  // namespace

TEST_GROUP(Certainty){};

TEST(Certainty, TellsTheLargestAndThePlacesAboveTheTolerance) {
  const Certainty sut = certainty_of(path_of({0.2, 1.2, 1.4, 0.3, 0.2, 1.1}), 1.0);
  DOUBLES_EQUAL(1.4, *sut.u95_mm, 1e-12);
  DOUBLES_EQUAL(3, sut.at_mm, 1e-12);
  LONGS_EQUAL(2, sut.places.size());
  DOUBLES_EQUAL(2, sut.places[0].from_mm, 1e-12);
  DOUBLES_EQUAL(3, sut.places[0].to_mm, 1e-12);
  DOUBLES_EQUAL(1.4, *sut.places[0].u95_mm, 1e-12);
  DOUBLES_EQUAL(6, sut.places[1].from_mm, 1e-12);
}

TEST(Certainty, OnePlaceThatIsNotKnownLeavesThePathNotKnown) {
  const Certainty sut = certainty_of(path_of({0.2, std::nullopt, 0.3}), 1.0);
  CHECK_FALSE(sut.u95_mm.has_value());
  LONGS_EQUAL(1, sut.places.size());
  CHECK_FALSE(sut.places[0].u95_mm.has_value());
  DOUBLES_EQUAL(2, sut.places[0].from_mm, 1e-12);
}

TEST(Certainty, WithoutAToleranceNoPlaceIsTooUncertain) {
  LONGS_EQUAL(0, certainty_of(path_of({0.2, 5.0}), std::nullopt).places.size());
}

TEST(Certainty, WhatTheWholeLineSharesIsCarriedToTheTipAsItIs) {
  cloud::ClosedLine line = test::made_line();
  for (cloud::LinePoint& p : line.points) p.u95_mm = 0.2;
  DOUBLES_EQUAL(0.2, most_mm(tool_path(line, 0)), 1e-9);
  DOUBLES_EQUAL(0.2, most_mm(tool_path(line, 100)), 1e-9);
}

TEST(Certainty, APlaceOfItsOwnTurnsAToolThatStandsOff) {
  cloud::ClosedLine line = test::made_line();
  for (cloud::LinePoint& p : line.points) p.u95_mm = 0.2;
  line.points[line.points.size() / 2].u95_mm = 1.0;
  // Between two waypoints, too: no millimetre of the line is left out.
  const double near_mm = most_mm(tool_path(line, 0));
  CHECK_COMPARE(near_mm, >=, 1.0);
  // 100 mm off with directions smoothed over 28 mm: sqrt(2) 0.98 / 56 rad turn it by 2.5 mm.
  const double far_mm = most_mm(tool_path(line, 100));
  CHECK_COMPARE(far_mm, >=, 2.2);
  CHECK_COMPARE(far_mm, <=, 3.2);
}

TEST(Certainty, ALineWithoutU95GivesAPathWithout) {
  const ToolPath sut = tool_path(test::made_line(), 0);
  for (const ToolPoint& point : sut.points) CHECK_FALSE(point.u95_mm.has_value());
}

TEST(Certainty, EveryShippedProcessAsksForOneMillimetre) {
  for (const char* name : {"grind.yaml", "rough.yaml", "cement.yaml", "spray.yaml"}) {
    const auto process = read_process(std::filesystem::path{BITELINE_PROCESSES} / name);
    CHECK_TEXT(process.has_value(), name);
    CHECK_TEXT(process->gate.tolerance_mm == 1.0, name);
  }
}

}  // namespace biteline::path
