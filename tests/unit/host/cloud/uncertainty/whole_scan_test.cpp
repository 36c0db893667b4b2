// SPDX-License-Identifier: MIT
#include "host/cloud/uncertainty/whole_scan.hpp"

#include <CppUTest/TestHarness.h>

#include <cmath>
#include <numbers>

namespace biteline::uncertainty {
namespace {

/// An arm that is off by 0.02 mm at x = -50 and by 0.06 mm at x = 50.
WholeScan with_arm() {
  return {.head = {},
          .arm = ArmMotion{.sigma_mm = 0.045,
                           .profiles = 200,
                           .places = {{.middle_base = {-50, 0, 0}, .sigma_mm = 0.02},
                                      {.middle_base = {50, 0, 0}, .sigma_mm = 0.06}}}};
}

Vec3 on_circle(std::size_t i) {
  const double turn_rad = 2 * std::numbers::pi * static_cast<double>(i) / 80;
  return {60 * std::cos(turn_rad), 60 * std::sin(turn_rad), 0};
}

}  // namespace

TEST_GROUP(WholeScan){};

TEST(WholeScan, NothingKnownIsZero) {
  const WholeScan nothing;
  CHECK(!nothing.known());
  DOUBLES_EQUAL(0, nothing.covariance_mm2({1, 2, 3}).norm(), 0);
  DOUBLES_EQUAL(0, SpreadAlong(nothing, 80, on_circle).at(7).norm(), 0);
}

TEST(WholeScan, AnArmAloneIsOffAlikeEachWayAsItsNearestPlaceTells) {
  const WholeScan sut = with_arm();
  CHECK(sut.known());
  CHECK(sut.covariance_mm2({-40, 5, 2}).isApprox(0.0004 * Mat3::Identity(), 1e-9));
  CHECK(sut.covariance_mm2({40, 5, 2}).isApprox(0.0036 * Mat3::Identity(), 1e-9));
}

TEST(WholeScan, AlongALineItGoesStraightFromOneEighthPointToTheNext) {
  const WholeScan scan = with_arm();
  const SpreadAlong sut{scan, 80, on_circle};
  // Point 16 lies at x = 18, point 24 at x = -18.
  DOUBLES_EQUAL(0.0036, sut.at(16)(2, 2), 1e-9);
  DOUBLES_EQUAL(0.0004, sut.at(24)(2, 2), 1e-9);
  DOUBLES_EQUAL((0.0036 + 0.0004) / 2, sut.at(20)(2, 2), 1e-9);
  DOUBLES_EQUAL(0.0036, sut.at(79)(2, 2), 1e-9);  // towards the first one
}

TEST(WholeScan, AcrossALineIsOutwardsThenUp) {
  const Mat3 covariance = Vec3{0.01, 0.04, 0.09}.asDiagonal();
  const Eigen::Matrix2d sut = across(covariance, Vec3::UnitY(), Vec3::UnitZ());
  DOUBLES_EQUAL(0.01, sut(0, 0), 1e-12);  // what lies along the line does not count
  DOUBLES_EQUAL(0.09, sut(1, 1), 1e-12);
  DOUBLES_EQUAL(0, sut(0, 1), 1e-12);
}

TEST(WholeScan, ALineThatStandsUprightHasItsSpreadInTheLevelPlane) {
  const Mat3 covariance = Vec3{1, 1, 9}.asDiagonal();
  const Eigen::Matrix2d level = across(covariance, Vec3::UnitZ(), Vec3::UnitZ());
  CHECK((level - Eigen::Matrix2d::Identity()).norm() < 1e-12);
}

}  // namespace biteline::uncertainty
