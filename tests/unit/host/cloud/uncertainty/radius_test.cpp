// SPDX-License-Identifier: MIT
#include "host/cloud/uncertainty/radius.hpp"

#include <CppUTest/TestHarness.h>

#include <Eigen/Geometry>
#include <cmath>

namespace biteline::uncertainty {

TEST_GROUP(Radius){};

TEST(Radius, ARoundDistributionIsRayleighs) {
  for (const double r_mm : {0.1, 0.5, 1.0, 3.0})
    DOUBLES_EQUAL(1 - std::exp(-0.5 * r_mm * r_mm / 0.25), chance_within({0.5, 0.5}, r_mm), 1e-6);
  // sqrt(-2 ln 0.05) = 2.4477
  DOUBLES_EQUAL(2.447747 * 0.5, u95_mm({0.5, 0.5}, 1, 0), 1e-4);
}

TEST(Radius, AFlatDistributionIsTheNormalOne) {
  DOUBLES_EQUAL(std::erf(1 / std::sqrt(2.0)), chance_within({0.2, 0}, 0.2), 1e-6);
  DOUBLES_EQUAL(1.959964 * 0.2, u95_mm({0.2, 0}, 1, 0), 1e-4);
}

TEST(Radius, HoldsWhatItSaysWhateverTheShape) {
  for (const double minor_mm : {0.01, 0.07, 0.23, 0.5, 0.81, 0.99}) {
    const Axes axes{1, minor_mm};
    DOUBLES_EQUAL(0.95, chance_within(axes, u95_mm(axes, 1, 0)), 1e-4);
  }
}

TEST(Radius, AxesAreThoseOfTheMatrix) {
  // Turned by 30 degrees, deviations 3 and 1.
  const Eigen::Rotation2D<double> turn{0.5235987756};
  const Eigen::Matrix2d R = turn.toRotationMatrix();
  const Axes sut = principal_axes(R * Eigen::Vector2d{9, 1}.asDiagonal() * R.transpose());
  DOUBLES_EQUAL(3, sut.major_mm, 1e-9);
  DOUBLES_EQUAL(1, sut.minor_mm, 1e-9);
}

TEST(Radius, AnUnsureLayerIsReachedBeyondOneInTwenty) {
  // 90 % here, 10 % a layer 5 mm off: half of that must be held, so the circle reaches it.
  DOUBLES_EQUAL(5, u95_mm({0.05, 0.05}, 0.90, 5), 1e-3);
  // 97 % here: 0.95 / 0.97 of what is here is enough.
  const double sut_mm = u95_mm({0.05, 0.05}, 0.97, 5);
  DOUBLES_EQUAL(0.95, 0.97 * chance_within({0.05, 0.05}, sut_mm), 1e-5);
  CHECK(sut_mm < 0.2);
}

TEST(Radius, NoSpreadIsNoRadius) {
  DOUBLES_EQUAL(0, u95_mm({0, 0}, 1, 0), 1e-4);
  DOUBLES_EQUAL(0, chance_within({0.1, 0.1}, 0), 1e-12);
}

}  // namespace biteline::uncertainty
