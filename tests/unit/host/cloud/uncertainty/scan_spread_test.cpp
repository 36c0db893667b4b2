// SPDX-License-Identifier: MIT
#include "host/cloud/uncertainty/scan_spread.hpp"

#include <CppUTest/TestHarness.h>

#include <vector>

#include "tests/support/uncertain_scan.hpp"

namespace biteline::uncertainty {

TEST_GROUP(ScanSpread) {
  test::UncertainScan scan = test::uncertain_scan({.profile_step_mm = 5});
  Vec3 somewhere() const {
    return scan.cloud.points[scan.cloud.size() / 3].cast<double>();
  }
};

TEST(ScanSpread, KnownExactlyNothingIsOff) {
  scan.head.uncertainty.covariance.setZero();
  scan.head.uncertainty.pose_sigma_mm = scan.head.uncertainty.pose_sigma_rad = 0;
  const ScanSpread sut{scan.head, scan.poses};
  DOUBLES_EQUAL(0, sut.covariance_mm2(somewhere()).norm(), 1e-12);
}

TEST(ScanSpread, AClockMovesAPointAlongTheArmsWay) {
  scan.head.uncertainty.covariance.setZero();
  scan.head.uncertainty.covariance(k_clock_at, k_clock_at) = 1e-6;  // (1 ms)^2
  scan.head.uncertainty.pose_sigma_mm = scan.head.uncertainty.pose_sigma_rad = 0;
  const ScanSpread sut{scan.head, scan.poses};
  // 100 mm/s along the outline for 1 ms; the surface beside the outline goes a little faster or slower.
  DOUBLES_EQUAL(0.1, std::sqrt(sut.covariance_mm2(somewhere()).trace()), 0.03);
}

TEST(ScanSpread, PosesAreOffByNoLessThanTheScanShows) {
  scan.head.uncertainty.covariance.setZero();
  scan.head.uncertainty.pose_sigma_mm = 0.03;
  scan.head.uncertainty.pose_sigma_rad = 0;
  const ScanSpread sut{scan.head, scan.poses};
  CHECK((sut.covariance_mm2(somewhere(), 0.05) - 0.05 * 0.05 * Mat3::Identity()).norm() < 1e-12);
  CHECK((sut.covariance_mm2(somewhere(), 0.02) - 0.03 * 0.03 * Mat3::Identity()).norm() < 1e-12);
}

TEST(ScanSpread, PosesAddTheirOwn) {
  scan.head.uncertainty.covariance.setZero();
  scan.head.uncertainty.pose_sigma_mm = 0.05;
  scan.head.uncertainty.pose_sigma_rad = 0;
  const ScanSpread sut{scan.head, scan.poses};
  CHECK((sut.covariance_mm2(somewhere()) - 0.05 * 0.05 * Mat3::Identity()).norm() < 1e-12);
}

TEST(ScanSpread, WithoutPosesOrFarAwayNothingIsSaid) {
  DOUBLES_EQUAL(0, (ScanSpread{scan.head, {}}.covariance_mm2(somewhere()).norm()), 0);
  DOUBLES_EQUAL(0, (ScanSpread{scan.head, scan.poses}.covariance_mm2(Vec3{1e4, 0, 0}).norm()), 0);
}

}  // namespace biteline::uncertainty
