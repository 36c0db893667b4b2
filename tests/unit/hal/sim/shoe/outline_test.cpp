// SPDX-License-Identifier: MIT
#include "hal/sim/shoe/outline.hpp"

#include <CppUTest/TestHarness.h>

#include <cmath>

namespace biteline::sim {

TEST_GROUP(Outline) {
  OutlineShape shape{.length_mm = 270, .width_ratio = 1.05, .left_foot = false, .jitter = {}};
};

TEST(Outline, RunsAtUnitSpeedSoThatPlacesAreArcLengths) {
  const Outline sut(shape);
  constexpr double k_step_mm = 0.5;
  for (double s_mm = -20; s_mm < sut.perimeter_mm() + 20; s_mm += 7.3) {
    const double chord_mm = (sut.at(s_mm + k_step_mm).point - sut.at(s_mm).point).norm();
    // A chord of an arc of radius R is shorter by step^3 / (24 R^2); no outline here bends tighter than 10
    // mm.
    DOUBLES_EQUAL(k_step_mm, chord_mm, k_step_mm * k_step_mm * k_step_mm / (24 * 10 * 10) + 1e-6);
  }
}

TEST(Outline, StandsHeelAtZeroToeAtItsLength) {
  const Outline sut(shape);
  double low = 1e9, high = -1e9;
  for (double s_mm = 0; s_mm < sut.perimeter_mm(); s_mm += 0.05) {
    low = std::min(low, sut.at(s_mm).point.x());
    high = std::max(high, sut.at(s_mm).point.x());
  }
  DOUBLES_EQUAL(0, low, 1e-3);
  DOUBLES_EQUAL(270, high, 1e-3);
}

TEST(Outline, RunsAnticlockwiseWithItsNormalOutwardsOnBothFeet) {
  for (const bool left : {false, true}) {
    shape.left_foot = left;
    const Outline sut(shape);
    double area_mm2 = 0, turned_rad = 0;
    constexpr double k_step_mm = 0.2;
    for (double s_mm = 0; s_mm < sut.perimeter_mm(); s_mm += k_step_mm) {
      const auto place = sut.at(s_mm);
      area_mm2 +=
          0.5 * k_step_mm * (place.point.x() * place.tangent.y() - place.point.y() * place.tangent.x());
      turned_rad += k_step_mm * place.curvature_per_mm;
      DOUBLES_EQUAL(-1, place.normal.x() * place.tangent.y() * -1 + place.normal.y() * place.tangent.x(),
                    1e-12);
    }
    CHECK(area_mm2 > 15000);
    DOUBLES_EQUAL(2 * M_PI, turned_rad, 0.02);
  }
}

TEST(Outline, LeftFootIsTheRightFootMirrored) {
  const Outline right(shape);
  shape.left_foot = true;
  const Outline left(shape);
  DOUBLES_EQUAL(right.perimeter_mm(), left.perimeter_mm(), 1e-6);
  // The widest places lie on opposite sides.
  const auto widest_y = [](const Outline& outline) {
    double widest = 0;
    for (double s_mm = 0; s_mm < outline.perimeter_mm(); s_mm += 0.5) {
      const double y = outline.at(s_mm).point.y();
      if (std::abs(y) > std::abs(widest)) widest = y;
    }
    return widest;
  };
  DOUBLES_EQUAL(widest_y(right), -widest_y(left), 0.02);
}

TEST(Outline, WayIsTheShorterOneAndKeepsItsSign) {
  const Outline sut(shape);
  DOUBLES_EQUAL(10, sut.way_mm(sut.perimeter_mm() - 5, 5), 1e-9);
  DOUBLES_EQUAL(-10, sut.way_mm(5, -5), 1e-9);
}

}  // namespace biteline::sim
