// SPDX-License-Identifier: MIT
#include "host/robot/path/checks/line_check.hpp"

#include <CppUTest/TestHarness.h>

#include <cfenv>
#include <limits>

#include <algorithm>

#include "tests/unit/host/robot/path/made_line.hpp"

namespace biteline::path {
namespace {

/// Names of the failed checks, joined.
std::string failed(const cloud::ClosedLine& line) {
  std::string names;
  for (const Check& check : check_line(line)) {
    if (!check.passed) names += check.name + ";";
  }
  return names;
}

}  // namespace

TEST_GROUP(LineCheck) {
  cloud::ClosedLine line = test::made_line();
};

TEST(LineCheck, GoodLinePasses) {
  CHECK(failed(line).empty());
}

TEST(LineCheck, WhatAPersonMustSettleIsNoWayForATool) {
  const std::size_t tenth = line.points.size() / 10;
  for (std::size_t i = 0; i < tenth; ++i) line.points[i].flags |= cloud::k_line_unsure;
  CHECK(failed(line).empty());
  for (std::size_t i = 0; i < 2 * tenth; ++i) line.points[i].flags |= cloud::k_line_unsure;
  STRCMP_EQUAL("settled;", failed(line).c_str());
}

TEST(LineCheck, OpenLineIsRefused) {
  line.points.resize(line.points.size() - 30);
  STRCMP_EQUAL("closed;", failed(line).c_str());
}

TEST(LineCheck, HoleIsRefusedAndItsPlaceTold) {
  line.points.erase(line.points.begin() + 100, line.points.begin() + 108);
  STRCMP_EQUAL("spacing;", failed(line).c_str());
  for (const Check& check : check_line(line)) {
    if (!check.passed) DOUBLES_EQUAL(99.0, check.arc_mm, 2.0);
  }
}

TEST(LineCheck, FigureOfEightIsRefused) {
  // A loop: points 300 to 320 visited backwards.
  std::reverse(line.points.begin() + 300, line.points.begin() + 301);
  std::swap(line.points[300].position, line.points[302].position);
  line.points[301].position += Vec3{0, 0.8, 0};
  CHECK(failed(line).find("no self-crossing") != std::string::npos);
}

TEST(LineCheck, ClockwiseLineIsRefused) {
  std::ranges::reverse(line.points);
  for (cloud::LinePoint& p : line.points) p.tangent = -p.tangent;
  CHECK(failed(line).find("anticlockwise") != std::string::npos);
}

TEST(LineCheck, InwardNormalIsRefused) {
  line.points[7].normal = -line.points[7].normal;
  STRCMP_EQUAL("normals outward;", failed(line).c_str());
}

TEST(LineCheck, DirectionsOfTheFileAreNotTrusted) {
  // A circle that carries one normal and one tangent, copied to each point: they agree with each other.
  cloud::ClosedLine circle = test::made_line({.half_length_mm = 60, .half_width_mm = 60});
  for (cloud::LinePoint& p : circle.points) {
    p.normal = circle.points[0].normal;
    p.tangent = circle.points[0].tangent;
  }
  STRCMP_EQUAL("normals outward;tangents along the line;normals across the line;", failed(circle).c_str());
  cloud::ClosedLine upwards = test::made_line();
  for (cloud::LinePoint& p : upwards.points) p.normal = Vec3::UnitZ();
  STRCMP_EQUAL("normals outward;", failed(upwards).c_str());
  cloud::ClosedLine backwards = test::made_line();
  for (cloud::LinePoint& p : backwards.points) p.tangent = -p.tangent;
  STRCMP_EQUAL("tangents along the line;", failed(backwards).c_str());
}

TEST(LineCheck, NumbersThatAreNoneFailBeforeAnythingIsMadeOfThem) {
  constexpr double k_nan = std::numeric_limits<double>::quiet_NaN();
  for (const double bad : {k_nan, std::numeric_limits<double>::infinity(), 1e9, 1e12, 1e300, -1.1e5}) {
    line = test::made_line();
    line.points[95].position.x() = bad;
    STRCMP_EQUAL("points;", failed(line).c_str());
    line = test::made_line();
    line.points[95].normal.z() = bad;
    STRCMP_EQUAL("points;", failed(line).c_str());
  }
  STRCMP_EQUAL("points;", failed({}).c_str());
  cloud::ClosedLine endless;
  endless.points.assign(1'000'000, test::made_line().points[0]);
  STRCMP_EQUAL("points;", failed(endless).c_str());
  std::feclearexcept(FE_ALL_EXCEPT);  // raised on purpose
}

}  // namespace biteline::path
