// SPDX-License-Identifier: MIT
#include "host/transfer/carry/carried_line.hpp"

#include <CppUTest/TestHarness.h>

#include <algorithm>

#include "host/transfer/carry/scan_mesh.hpp"
#include "tests/support/made_drum.hpp"

namespace biteline::transfer {
namespace {

constexpr double k_line_z_mm = 12;
constexpr double k_noise_mm = 0.02;

/// A circle inside the drum's wall, as a sample's groove lies inside the upper's.
std::vector<PlacedPoint> placed_circle(int points = 300) {
  std::vector<PlacedPoint> placed;
  for (int i = 0; i < points; ++i) {
    const double turn_rad = 2 * std::numbers::pi * (i + 0.37) / points;
    const Vec3 outward{std::cos(turn_rad), std::sin(turn_rad), 0};
    // A crease's own normal points somewhat up: level rays must not follow it.
    placed.push_back({.position = 47.5 * outward + k_line_z_mm * Vec3::UnitZ(),
                      .normal = (outward + 0.4 * Vec3::UnitZ()).normalized(),
                      .confidence = 0.9});
  }
  return placed;
}

}  // namespace

TEST_GROUP(CarriedLine) {
  test::DrumScan scan{.noise_mm = k_noise_mm};
  CarriedLine carried(const CarryOptions& options = {}) {
    return carry_line(*ScanMesh::create(scan.scan()), placed_circle(), options);
  }
};

TEST(CarriedLine, LevelRaysKeepTheHeightAndTakeTheSurfacesNormals) {
  // A cone: the radius falls by 0.3 mm per mm of height, so the outward normal rises by atan(0.3).
  scan.bulge_mm = [](double, double z_mm) { return -0.3 * (z_mm - k_line_z_mm); };
  const CarriedLine sut = carried();
  LONGS_EQUAL(300, sut.hits);
  const Vec3 slope = Vec3{1, 0, 0.3}.normalized();
  for (const cloud::LinePoint& p : sut.line.points) {
    DOUBLES_EQUAL(k_line_z_mm, p.position.z(), 0.001);
    DOUBLES_EQUAL(50.0, p.position.head<2>().norm(), 4 * k_noise_mm);
    DOUBLES_EQUAL(slope.z(), p.normal.z(), 0.02);  // 1 degree
    DOUBLES_EQUAL(1.0, p.normal.norm(), 1e-9);
    DOUBLES_EQUAL(1.0, p.tangent.norm(), 1e-9);
    CHECK(p.confidence > 0.8);
  }
}

TEST(CarriedLine, TheSamplesOwnU95StaysInThatOfItsPoints) {
  std::vector<PlacedPoint> placed = placed_circle();
  const CarriedLine alone = carry_line(*ScanMesh::create(scan.scan()), placed, {});
  for (PlacedPoint& point : placed) point.sample_u95_mm = 0.4;
  const CarriedLine sut = carry_line(*ScanMesh::create(scan.scan()), placed, {});
  for (std::size_t i = 0; i < sut.line.points.size(); ++i)
    DOUBLES_EQUAL(std::hypot(*alone.line.points[i].u95_mm, 0.4), *sut.line.points[i].u95_mm, 1e-9);
}

TEST(CarriedLine, RaysAlongTheNormalLeaveTheHeight) {
  const CarriedLine sut = carried({.direction = RayDirection::Normal});
  for (const cloud::LinePoint& p : sut.line.points)
    DOUBLES_EQUAL(k_line_z_mm + 0.4 * 2.5, p.position.z(), 0.05);
}

TEST(CarriedLine, IsClosedEvenAndAnticlockwiseWhicheverWayTheSampleRan) {
  for (const bool reversed : {false, true}) {
    std::vector<PlacedPoint> placed = placed_circle();
    if (reversed) std::reverse(placed.begin(), placed.end());
    const CarriedLine sut = carry_line(*ScanMesh::create(scan.scan()), placed, {});
    const std::vector<cloud::LinePoint>& points = sut.line.points;
    const double step_mm = (points[1].position - points[0].position).norm();
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec3 &p = points[i].position, &q = points[(i + 1) % points.size()].position;
      DOUBLES_EQUAL(step_mm, (q - p).norm(), 0.02);
      CHECK(p.cross(q).z() > 0);
      CHECK(points[i].tangent.dot(q - p) > 0);
    }
  }
}

TEST(CarriedLine, AGapIsBridgedAndMarked) {
  scan.missing = [](double turn_rad, double z_mm) {
    return turn_rad > 2 && turn_rad < 2.2 && z_mm < 20;
  };  // 10 mm
  const CarriedLine sut = carried();
  CHECK_FALSE(sut.refusal.has_value());
  DOUBLES_EQUAL(10.0, sut.longest_gap_mm, 3);
  std::size_t marked = 0;
  for (std::size_t i = 0; i < sut.line.points.size(); ++i) {
    const cloud::LinePoint& p = sut.line.points[i];
    const double turn_rad = std::atan2(p.position.y(), p.position.x());
    if (sut.bridged[i]) {
      ++marked;
      CHECK(turn_rad > 1.97 && turn_rad < 2.23);
      CHECK(p.confidence < 0.6);
      // The straight way from ray to ray keeps the distance, not the chord.
      DOUBLES_EQUAL(50.0, p.position.head<2>().norm(), 0.15);
      CHECK(p.normal.head<2>().dot(p.position.head<2>().normalized()) > 0.98);
    } else {
      CHECK(turn_rad < 2.0 + 0.03 || turn_rad > 2.2 - 0.03);
    }
  }
  CHECK(marked >= 8);
}

TEST(CarriedLine, AGapIsBridgedAsTheSamplesWallRuns) {
  // Where the upper is not seen the sample's groove is filled: its line lies 2 mm farther out.
  scan.missing = [](double turn_rad, double z_mm) { return turn_rad > 2 && turn_rad < 2.2 && z_mm < 20; };
  std::vector<PlacedPoint> placed = placed_circle();
  for (PlacedPoint& p : placed) {
    const double turn_rad = std::atan2(p.position.y(), p.position.x());
    if (turn_rad > 2.05 && turn_rad < 2.15) p.position.head<2>() *= 49.5 / 47.5;
    p.wall_mm = 50.3 - p.position.head<2>().norm();
  }
  const CarriedLine sut = carry_line(*ScanMesh::create(scan.scan()), placed, {});
  CHECK_TEXT(!sut.refusal, sut.refusal ? sut.refusal->reason.c_str() : "");
  CHECK(sut.bridged_mm > 8);
  for (const cloud::LinePoint& p : sut.line.points) DOUBLES_EQUAL(50.0, p.position.head<2>().norm(), 0.1);
}

TEST(CarriedLine, ATooLongGapIsRefusedWithItsPlace) {
  scan.missing = [](double turn_rad, double z_mm) {
    return turn_rad > 3 && turn_rad < 3.4 && z_mm < 20;
  };  // 20 mm
  const CarriedLine sut = carried();
  CHECK(sut.line.points.empty());
  CHECK(sut.refusal->code == Refused::ScanHasGap);
  STRCMP_CONTAINS("x -4", sut.refusal->reason.c_str());
}

TEST(CarriedLine, SomethingThatStandsOutIsNotFollowed) {
  scan.bulge_mm = [](double turn_rad, double z_mm) {
    return turn_rad > 1 && turn_rad < 1.06 && z_mm > 8 ? 6 : 0;
  };
  const CarriedLine sut = carried();
  CHECK_FALSE(sut.refusal.has_value());
  for (const cloud::LinePoint& p : sut.line.points) DOUBLES_EQUAL(50.0, p.position.head<2>().norm(), 0.2);
}

TEST(CarriedLine, NoHitAtAllIsRefused) {
  std::vector<PlacedPoint> placed = placed_circle();
  for (PlacedPoint& p : placed) p.position.z() += 500;
  const CarriedLine sut = carry_line(*ScanMesh::create(scan.scan()), placed, {});
  CHECK(sut.refusal.has_value());
}

}  // namespace biteline::transfer
