// SPDX-License-Identifier: MIT
#include "host/transfer/carry/scan_mesh.hpp"

#include <CppUTest/TestHarness.h>

#include "tests/support/made_drum.hpp"

namespace biteline::transfer {
namespace {

// A chord of 300 stripes round R = 50 mm lies inside by R (1 - cos(pi / 300)) = 0.003 mm.
constexpr double k_chord_mm = 0.003;

Ray outward_ray(double turn_rad, double z_mm, double from_mm) {
  const Vec3 direction{std::cos(turn_rad), std::sin(turn_rad), 0};
  return {.origin = from_mm * direction + z_mm * Vec3::UnitZ(), .direction = direction, .reach_mm = 15};
}

}  // namespace

TEST_GROUP(ScanMesh) {
  std::mt19937_64 random{29};
  std::uniform_real_distribution<double> unit{0, 1};
  double random_turn_rad() {
    return 2 * std::numbers::pi * unit(random);
  }
};

TEST(ScanMesh, RaysMeetTheSurfaceWhereTheFormulaSays) {
  const ScanMesh sut = *ScanMesh::create(test::DrumScan{}.scan());
  CHECK(sut.closed());
  for (int i = 0; i < 500; ++i) {
    const double from_mm = 50 + 20 * (unit(random) - 0.5);  // from inside and from outside
    const std::optional<Hit> hit = sut.cast(outward_ray(random_turn_rad(), 1 + 28 * unit(random), from_mm));
    CHECK(hit.has_value());
    DOUBLES_EQUAL(50 - from_mm, hit->distance_mm, k_chord_mm);
    DOUBLES_EQUAL(50.0, hit->position.head<2>().norm(), k_chord_mm);
    CHECK(hit->normal.dot(Vec3{hit->position.x(), hit->position.y(), 0}.normalized()) > 0.999);
  }
}

TEST(ScanMesh, CastAgreesWithAllTrianglesOneByOne) {
  test::DrumScan scan{.profiles = 60, .columns = 50, .noise_mm = 0.02};
  scan.bulge_mm = [](double turn_rad, double z_mm) {
    return 2 * std::sin(3 * turn_rad) * std::cos(z_mm / 4);
  };
  const ScanMesh sut = *ScanMesh::create(scan.scan());
  const std::vector<ScanMesh::Triangle> triangles = sut.triangles();
  for (int i = 0; i < 100; ++i) {
    const Ray ray = outward_ray(random_turn_rad(), 1 + 28 * unit(random), 48);
    double nearest_mm = ray.reach_mm;
    for (const ScanMesh::Triangle& t : triangles) {
      // Closed form by Cramer's rule: origin + d * direction = a + u * ab + v * ac.
      const Vec3 a = sut.points()[t[0]].cast<double>(), ab = sut.points()[t[1]].cast<double>() - a,
                 ac = sut.points()[t[2]].cast<double>() - a;
      Mat3 M;
      M << ab, ac, -ray.direction;
      if (std::abs(M.determinant()) < 1e-9) continue;
      const Vec3 x = M.inverse() * (ray.origin - a);
      if (x[0] >= 0 && x[1] >= 0 && x[0] + x[1] <= 1 && std::abs(x[2]) < std::abs(nearest_mm))
        nearest_mm = x[2];
    }
    const std::optional<Hit> hit = sut.cast(ray);
    CHECK(hit.has_value());
    DOUBLES_EQUAL(nearest_mm, hit->distance_mm, 1e-6);
  }
}

TEST(ScanMesh, TrianglesLookOutwardWhicheverWayTheScanWent) {
  for (const bool clockwise : {false, true}) {
    const ScanMesh sut = *ScanMesh::create(test::DrumScan{.clockwise = clockwise}.scan());
    const std::vector<ScanMesh::Triangle> triangles = sut.triangles();
    LONGS_EQUAL(2 * 300 * 199, triangles.size());
    for (std::size_t i = 0; i < triangles.size(); i += 97) {
      const auto& [a, b, c] = triangles[i];
      const Eigen::Vector3f n = (sut.points()[b] - sut.points()[a]).cross(sut.points()[c] - sut.points()[a]);
      CHECK(n.dot(Eigen::Vector3f(sut.points()[a].x(), sut.points()[a].y(), 0)) > 0);
    }
  }
}

TEST(ScanMesh, AHoleStaysAHole) {
  test::DrumScan scan;
  scan.missing = [](double turn_rad, double z_mm) {
    return turn_rad > 1 && turn_rad < 1.2 && z_mm > 10 && z_mm < 20;
  };
  const ScanMesh sut = *ScanMesh::create(scan.scan());
  CHECK_FALSE(sut.cast(outward_ray(1.1, 15, 45)).has_value());
  CHECK(sut.cast(outward_ray(1.1, 25, 45)).has_value());
  CHECK(sut.cast(outward_ray(0.9, 15, 45)).has_value());
}

TEST(ScanMesh, OneMissingColumnIsNoHole) {
  test::DrumScan scan;
  scan.missing = [](double, double z_mm) { return z_mm > 15.0 && z_mm < 15.16; };  // one of 0.15 mm
  const ScanMesh sut = *ScanMesh::create(scan.scan());
  CHECK(sut.cast(outward_ray(2, 15.08, 45)).has_value());
}

TEST(ScanMesh, AnEdgeIsNotBridged) {
  // The lower half stands out by 4 mm: no triangle leads from one half to the other.
  test::DrumScan scan;
  scan.bulge_mm = [](double, double z_mm) { return z_mm < 15 ? 4 : 0; };
  const ScanMesh sut = *ScanMesh::create(scan.scan());
  for (const auto& [a, b, c] : sut.triangles()) {
    const bool lower = sut.points()[a].z() < 15;
    CHECK(lower == (sut.points()[b].z() < 15) && lower == (sut.points()[c].z() < 15));
  }
}

TEST(ScanMesh, TheNearestOfTwoWallsCountsAndItsBackDoesNot) {
  // From 48 mm the inner face of the bulge at -4 looks away; the wall at +2 is hit.
  const ScanMesh sut = *ScanMesh::create(test::DrumScan{}.scan());
  const Ray inward{.origin = {48, 0, 15}, .direction = {-1, 0, 0}, .reach_mm = 15};
  CHECK_FALSE(sut.cast(inward).has_value());
}

TEST(ScanMesh, CloudsWithoutOrderOrWithOneProfileAreRefused) {
  cloud::PointCloud cloud = test::DrumScan{.profiles = 1}.scan();
  CHECK(ScanMesh::create(cloud).error().code == Errc::Refused);
  cloud.column.clear();
  CHECK(ScanMesh::create(cloud).error().code == Errc::InvalidArgument);
}

// A file whose bytes are shifted: each point is a profile of its own, its column any.
TEST(ScanMesh, ScanLargerThanAnyIsRefusedBeforeItTakesTheMemory) {
  cloud::PointCloud cloud;
  for (std::uint32_t i = 0; i < 2000; ++i) {
    cloud.points.emplace_back(static_cast<float>(i), 0.0F, 0.0F);
    cloud.profile.push_back(i);
    cloud.column.push_back(static_cast<std::uint16_t>(i * 30));
  }
  const auto sut = ScanMesh::create(cloud);
  CHECK(!sut.has_value());
  STRCMP_CONTAINS("2000 profiles of 59971 columns", sut.error().where.c_str());
}

}  // namespace biteline::transfer
