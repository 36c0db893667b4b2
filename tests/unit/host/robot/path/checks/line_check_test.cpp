// SPDX-License-Identifier: MIT
#include "host/robot/path/checks/line_check.hpp"

#include <CppUTest/TestHarness.h>

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

}  // namespace biteline::path
