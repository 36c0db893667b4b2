// SPDX-License-Identifier: MIT
#include "host/transfer/carry/beside_line.hpp"

#include <CppUTest/TestHarness.h>

#include "host/transfer/carry/point_surface.hpp"
#include "tests/support/made_drum.hpp"

namespace biteline::transfer {

TEST_GROUP(BesideLine){};

TEST(BesideLine, TheLineIsThatOfAllPoints) {
  constexpr double k_line_z_mm = 60;
  test::DrumScan scan{.height_mm = 120, .columns = 250, .noise_mm = 0.02};
  scan.missing = [](double turn_rad, double z_mm) {
    return turn_rad > 1 && turn_rad < 1.15 && z_mm > 50 && z_mm < 70;
  };
  const cloud::PointCloud cloud = scan.scan();
  std::vector<PlacedPoint> placed;
  for (int i = 0; i < 500; ++i) {
    const double turn_rad = 2 * std::numbers::pi * i / 500;
    const Vec3 outward{std::cos(turn_rad), std::sin(turn_rad), 0};
    // Nearly as far from the wall as a ray goes, to one side and to the other.
    const double radius_mm = 50 + 14 * std::sin(3 * turn_rad);
    placed.push_back({.position = radius_mm * outward + k_line_z_mm * Vec3::UnitZ(), .normal = outward});
  }
  const CarryOptions options{.max_gap_mm = 45};
  const std::vector<Eigen::Vector3f> beside = points_beside(cloud.points, placed, options);
  CHECK(beside.size() < cloud.size() / 2);
  const CarriedLine whole = carry_line(PointSurface{cloud.points}, placed, options);
  const CarriedLine sut = carry_line(PointSurface{beside}, placed, options);
  CHECK_TEXT(!whole.refusal, whole.refusal ? whole.refusal->reason.c_str() : "");
  CHECK(whole.bridged_mm > 0);
  LONGS_EQUAL(whole.line.points.size(), sut.line.points.size());
  for (std::size_t i = 0; i < sut.line.points.size(); ++i) {
    DOUBLES_EQUAL(0, (whole.line.points[i].position - sut.line.points[i].position).norm(), 0);
    DOUBLES_EQUAL(0, (whole.line.points[i].normal - sut.line.points[i].normal).norm(), 0);
  }
}

}  // namespace biteline::transfer
