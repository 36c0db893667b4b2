// SPDX-License-Identifier: MIT
#include "host/robot/path/targets.hpp"

#include <CppUTest/TestHarness.h>

#include <cmath>
#include <numbers>
#include <random>

namespace biteline::path {
namespace {

std::vector<Vec3> arc(double radius_mm, double angle_rad, double step_mm) {
  std::vector<Vec3> way;
  const int count = static_cast<int>(radius_mm * angle_rad / step_mm);
  for (int i = 0; i <= count; ++i) {
    const double a = angle_rad * i / count;
    way.emplace_back(radius_mm * std::cos(a), radius_mm * std::sin(a), 0.0);
  }
  return way;
}

}  // namespace

TEST_GROUP(Targets){};

TEST(Targets, SpacingIsTheWishedOneUnlessBlendsOrNumberNeedMore) {
  Motion motion;
  motion.spacing_mm = 3;
  motion.blend_mm = 1;
  DOUBLES_EQUAL(3, target_spacing_mm(motion, 700), 1e-12);
  motion.spacing_mm = 0.5;
  DOUBLES_EQUAL(1 / 0.49, target_spacing_mm(motion, 700), 1e-5);
  DOUBLES_EQUAL(9500.0 / 950, target_spacing_mm(motion, 9500), 1e-12);
}

/// Also where the way shakes, as a nozzle's does that stands off on a lever.
TEST(Targets, PlacesStandEvenlyAndAtLeastTheSpacingApart) {
  std::mt19937_64 random{3};
  std::normal_distribution<double> shake_mm{0, 0.05};
  for (const double shaken : {0.0, 1.0}) {
    std::vector<Vec3> way = arc(35, 5, 0.25);
    for (Vec3& p : way) p += shaken * Vec3{shake_mm(random), shake_mm(random), shake_mm(random)};
    const std::vector<FinePlace> places = even_places(way, 2.05);
    DOUBLES_EQUAL(0, (places.front().tip - way.front()).norm(), 1e-12);
    DOUBLES_EQUAL(0, (places.back().tip - way.back()).norm(), 1e-12);
    for (std::size_t i = 0; i + 1 < places.size(); ++i) {
      const double step_mm = (places[i + 1].tip - places[i].tip).norm();
      CHECK(step_mm >= 2.05 - 1e-9 && step_mm < 2.3);
      CHECK(places[i].sample <= places[i + 1].sample);
    }
  }
}

TEST(Targets, AWayShorterThanTheSpacingIsItsTwoEnds) {
  const std::vector<FinePlace> places = even_places(std::vector<Vec3>{{0, 0, 0}, {0.5, 0, 0}, {1, 0, 0}}, 2);
  CHECK_EQUAL(2U, places.size());
  DOUBLES_EQUAL(1, places[1].tip.x(), 1e-12);
}

/// Sagitta of a chord, s^2 / 8 R.
TEST(Targets, ChordErrorOfAnArcIsItsSagittaAndACornersItsBlends) {
  const std::vector<Vec3> way = arc(20, 2, 0.01);
  const std::vector<FinePlace> places = even_places(way, 4);
  const double step_mm = (places[1].tip - places[0].tip).norm();
  DOUBLES_EQUAL(step_mm * step_mm / 160, chord_error(way, places, 0).mm, 2e-3);
  std::vector<Vec3> corner;
  for (int i = -1000; i <= 1000; ++i) corner.emplace_back(std::max(i, 0) * 0.01, std::max(-i, 0) * 0.01, 0.0);
  // A right angle with its own target: the blend passes at r sin 45 degrees / 2.
  DOUBLES_EQUAL(0.5 * std::sin(std::numbers::pi / 4), chord_error(corner, even_places(corner, 2), 1).mm,
                0.02);
}

TEST(Targets, BlendsLeaveTheirNeighboursRoomAndStopAtBothEnds) {
  const std::vector<Vec3> tips{{0, 0, 0}, {3, 0, 0}, {4, 0, 0}, {6, 0, 0}, {20, 0, 0}};
  const std::vector<double> radii = blend_radii_mm(tips, 1);
  const double expected[] = {0, 0.49, 0.49, 0.98, 0};
  for (std::size_t i = 0; i < radii.size(); ++i) DOUBLES_EQUAL(expected[i], radii[i], 1e-12);
  CHECK(blend_radii_mm({}, 1).empty());
}

}  // namespace biteline::path
