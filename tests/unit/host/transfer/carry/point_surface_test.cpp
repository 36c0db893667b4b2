// SPDX-License-Identifier: MIT
#include "host/transfer/carry/point_surface.hpp"

#include <CppUTest/TestHarness.h>

#include <algorithm>

#include "tests/support/made_drum.hpp"

namespace biteline::transfer {

TEST_GROUP(PointSurface) {
  std::mt19937_64 random{31};
  std::uniform_real_distribution<double> unit{0, 1};

  PointSurface shuffled(const test::DrumScan& scan) {
    std::vector<Eigen::Vector3f> points = scan.scan().points;
    std::shuffle(points.begin(), points.end(), random);
    return PointSurface{points};
  }
  static Ray outward_ray(double turn_rad, double z_mm, double from_mm) {
    const Vec3 direction{std::cos(turn_rad), std::sin(turn_rad), 0};
    return {.origin = from_mm * direction + z_mm * Vec3::UnitZ(), .direction = direction, .reach_mm = 15};
  }
};

TEST(PointSurface, RaysMeetTheSurfaceWhereTheFormulaSays) {
  const PointSurface sut = shuffled({.noise_mm = 0.02});
  for (int i = 0; i < 300; ++i) {
    const double from_mm = 50 + 20 * (unit(random) - 0.5), z_mm = 3 + 24 * unit(random);
    const std::optional<Hit> hit = sut.cast(outward_ray(2 * std::numbers::pi * unit(random), z_mm, from_mm));
    CHECK(hit.has_value());
    // A plane over r = 1.8 mm on R = 50 mm lies inside by about r²/(8 R) = 0.008 mm; some 35 points average
    // the noise.
    DOUBLES_EQUAL(50 - from_mm, hit->distance_mm, 0.008 + 3 * 0.02 / std::sqrt(35.0));
    CHECK(hit->normal.dot(Vec3{hit->position.x(), hit->position.y(), 0}.normalized()) > 0.999);
  }
}

TEST(PointSurface, NothingIsMadeUpInAHoleOrBeyondTheEdge) {
  test::DrumScan scan;
  scan.missing = [](double turn_rad, double z_mm) {
    return turn_rad > 1 && turn_rad < 1.2 && z_mm > 10 && z_mm < 20;
  };
  const PointSurface sut = shuffled(scan);
  CHECK_FALSE(sut.cast(outward_ray(1.1, 15, 45)).has_value());
  CHECK_FALSE(sut.cast(outward_ray(2, 31.2, 45)).has_value());
  CHECK(sut.cast(outward_ray(2, 27, 45)).has_value());
}

TEST(PointSurface, NoPointsNoHit) {
  CHECK_FALSE(PointSurface{{}}.cast(outward_ray(0, 0, 45)).has_value());
}

}  // namespace biteline::transfer
