// SPDX-License-Identifier: MIT
#include "host/bite_line/side/plan_motion.hpp"

#include <CppUTest/TestHarness.h>

#include <cmath>

namespace biteline::bite_line {
namespace {

constexpr double k_reach_mm = 150;

/// Steps of a wall that bends with this radius, nine places 10 mm apart, by a motion.
PlanMotion fitted(const PlanMotion& motion, double radius_mm) {
  PlanMotionFit fit{k_reach_mm};
  for (int k = -4; k <= 4; ++k) {
    const double angle = 10 * k / radius_mm;
    const Vec2 normal{std::sin(angle), std::cos(angle)};
    const Vec2 place = radius_mm * (normal - Vec2::UnitY());
    fit.add(place, normal, normal.dot(motion.of(place)));
  }
  return fit.likeliest();
}

}  // namespace

TEST_GROUP(PlanMotionFit){};

TEST(PlanMotionFit, AStepOutwardsIsAShiftOfTheSameSize) {
  for (const double radius_mm : {40.0, 250.0, 1e6}) {
    const PlanMotion sut = fitted({.shift_mm = {0, 1.5}}, radius_mm);
    DOUBLES_EQUAL(1.5, sut.shift_mm.y(), 0.02);
    DOUBLES_EQUAL(0, sut.shift_mm.x(), 0.02);
    DOUBLES_EQUAL(0, k_reach_mm * sut.turn_rad, 0.05);
  }
}

TEST(PlanMotionFit, ASlantIsATurn) {
  // The prior holds a turn back by its share: 0.028 beside the 0.267 of the nine places.
  const PlanMotion sut = fitted({.turn_rad = 0.01}, 1e6);
  DOUBLES_EQUAL(0.01, sut.turn_rad, 0.11 * 0.01);
}

TEST(PlanMotionFit, ASlideAlongAFlatWallIsNotSeen) {
  const PlanMotion sut = fitted({.shift_mm = {3, 0}}, 1e6);
  DOUBLES_EQUAL(0, sut.shift_mm.norm(), 0.01);
  DOUBLES_EQUAL(0, sut.turn_rad, 1e-4);
}

TEST(PlanMotionFit, ASlideAlongABentWallShowsAtTheFarEnd) {
  // It may as well be a turn about the bend's middle, which moves the far end by less: both are told in part.
  const PlanMotion sut = fitted({.shift_mm = {2, 0}}, 200);
  const double far_mm = std::max(sut.of({k_reach_mm, 0}).norm(),
                                 std::max(sut.of({-k_reach_mm, 0}).norm(), sut.shift_mm.norm()));
  DOUBLES_EQUAL(1.5, far_mm, 0.5);
}

TEST(PlanMotionFit, WithoutStepsNothingMoved) {
  const PlanMotionFit sut{k_reach_mm};
  LONGS_EQUAL(0, sut.count());
  DOUBLES_EQUAL(0, sut.likeliest().of({100, 100}).norm(), 1e-12);
}

}  // namespace biteline::bite_line
