// SPDX-License-Identifier: MIT
#include <CppUTest/TestHarness.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "hal/sim/shoe/outline.hpp"
#include "host/bite_line/shoe/plan_shape.hpp"

namespace biteline::bite_line {
namespace {

std::vector<Vec2> ellipse(double length_mm, double breadth_mm) {
  std::vector<Vec2> curve;
  for (int i = 0; i < 720; ++i) {
    const double angle = i * std::numbers::pi / 360;
    curve.push_back({0.5 * length_mm * std::cos(angle), 0.5 * breadth_mm * std::sin(angle)});
  }
  return curve;
}

std::vector<Vec2> foot(bool left, double turned = 1) {
  const sim::Outline shoe{{.length_mm = 290, .left_foot = left}};
  std::vector<Vec2> curve;
  for (int i = 0; i < 800; ++i) curve.push_back(turned * shoe.at(shoe.perimeter_mm() * i / 800).point);
  return curve;
}

}  // namespace

TEST_GROUP(PlanShape){};

TEST(PlanShape, AnEllipseIsBroadestInTheMiddle) {
  const PlanShape sut = plan_shape(ellipse(300, 100));
  DOUBLES_EQUAL(0.5, sut.broadest_at, 0.01);
  // At a share t of the length an ellipse is 2 sqrt(t - t^2) of its breadth.
  DOUBLES_EQUAL(2 * std::sqrt(0.03 - 0.03 * 0.03), sut.end_breadth, 0.01);
  DOUBLES_EQUAL(0.6, sut.heel_breadth, 0.01);
}

TEST(PlanShape, FewPointsAreJoinedByStraightLines) {
  const std::vector<Vec2> kite{{0, 0}, {70, -20}, {100, 0}, {70, 20}};
  const PlanShape sut = plan_shape(kite);
  DOUBLES_EQUAL(0.7, sut.broadest_at, 0.01);
  DOUBLES_EQUAL(0.1, sut.end_breadth, 0.001);
  DOUBLES_EQUAL(1.0 / 7, sut.heel_breadth, 0.001);
}

TEST(PlanShape, AMadeShoeIsBroadestAtTheBallWhicheverEndIsInFront) {
  for (const bool left : {false, true}) {
    for (const double turned : {1.0, -1.0}) {
      const PlanShape sut = plan_shape(foot(left, turned));
      DOUBLES_EQUAL(0.70, sut.broadest_at, 0.03);
      CHECK(sut.end_breadth < 0.6);
      CHECK(sut.heel_breadth < 0.8);
      CHECK(shoe_chance(sut) > 0.95);
    }
  }
}

TEST(PlanShape, AnOvalABoxAndAnIronAreFarFromShoes) {
  CHECK(shoe_chance(plan_shape(ellipse(300, 120))) < 0.1);
  CHECK(shoe_chance(plan_shape(std::vector<Vec2>{{0, 0}, {290, 0}, {290, 110}, {0, 110}})) < 0.001);
  CHECK(shoe_chance(plan_shape(std::vector<Vec2>{{0, 0}, {240, -55}, {260, -55}, {260, 55}, {240, 55}})) <
        0.001);
}

TEST(PlanShape, NoCurveIsNoShoe) {
  CHECK(shoe_chance(plan_shape({})) < 0.001);
}

TEST(PlanShape, TheDistanceIsInStandardDeviations) {
  const ShoeOutlines alone{
      .mean = {0.7, 0.5, 0.6}, .whiten = {10, 0, 20, 0, 0, 40}, .limit = 2, .softness = 0.5};
  DOUBLES_EQUAL(3.0, distance_to_shoes({.broadest_at = 0.8, .end_breadth = 0.6, .heel_breadth = 0.65}, alone),
                1e-9);
  DOUBLES_EQUAL(0.5, shoe_chance({.broadest_at = 0.9, .end_breadth = 0.5, .heel_breadth = 0.6}, alone), 1e-9);
}

}  // namespace biteline::bite_line
