// SPDX-License-Identifier: MIT
#include <CppUTest/TestHarness.h>

#include <numbers>
#include <random>

#include "host/bite_line/evaluation/cloud_error.hpp"
#include "host/bite_line/evaluation/line_error.hpp"
#include "host/bite_line/evaluation/statistics.hpp"
#include "tests/support/transforms.hpp"

namespace biteline::evaluation {
namespace {

/// A ball of radius 50 mm as a fine mesh.  Its facets lie at most radius * (1 - cos(pi / 256)) = 0.004 mm
/// inside.
constexpr double k_radius_mm = 50;
constexpr double k_facet_mm = 0.008;  // twice that: both directions of the grid

cloud::TriangleMesh ball(const Vec3& centre) {
  constexpr int k_rings = 256, k_meridians = 512;
  cloud::TriangleMesh mesh;
  for (int i = 0; i <= k_rings; ++i) {
    for (int j = 0; j < k_meridians; ++j) {
      const double polar = std::numbers::pi * i / k_rings, azimuth = 2 * std::numbers::pi * j / k_meridians;
      const Vec3 n(std::sin(polar) * std::cos(azimuth), std::sin(polar) * std::sin(azimuth), std::cos(polar));
      mesh.vertices.push_back((centre + k_radius_mm * n).cast<float>());
    }
  }
  const auto id = [&](int i, int j) { return static_cast<std::uint32_t>(i * k_meridians + j % k_meridians); };
  for (int i = 0; i < k_rings; ++i) {
    for (int j = 0; j < k_meridians; ++j) {
      mesh.faces.push_back({id(i, j), id(i + 1, j), id(i + 1, j + 1)});
      mesh.faces.push_back({id(i, j), id(i + 1, j + 1), id(i, j + 1)});
    }
  }
  return mesh;
}

cloud::ClosedLine circle(double radius_mm, int points, double from_rad = 0) {
  cloud::ClosedLine line;
  for (int i = 0; i < points; ++i) {
    const double a = from_rad + 2 * std::numbers::pi * i / points;
    line.points.push_back({.position = {radius_mm * std::cos(a), radius_mm * std::sin(a), 10},
                           .normal = {std::cos(a), std::sin(a), 0},
                           .tangent = {-std::sin(a), std::cos(a), 0},
                           .confidence = 1});
  }
  return line;
}

}  // namespace

TEST_GROUP(Measure) {
  std::mt19937_64 random{3};
};

TEST(Measure, SignedDistanceIsPositiveOutside) {
  const Vec3 centre(300, -200, 80);
  const ReferenceSurface sut{ball(centre)};
  std::normal_distribution<double> normal;
  for (int i = 0; i < 200; ++i) {
    const Vec3 n = Vec3(normal(random), normal(random), normal(random)).normalized();
    const double height_mm = 2 * normal(random);
    const auto found = sut.nearest(centre + (k_radius_mm + height_mm) * n, 20);
    CHECK(found.has_value());
    DOUBLES_EQUAL(height_mm, found->signed_distance_mm, k_facet_mm);
  }
  CHECK(!sut.nearest(centre + 2 * k_radius_mm * Vec3::UnitX(), 20).has_value());
}

TEST(Measure, SignIsRightBesideASharpValley) {
  // A right-angled valley along y: beside its bottom the nearest point is shared, or is the edge itself.
  const ReferenceSurface sut{
      {.vertices = {{-10, -10, 10}, {0, -10, 0}, {10, -10, 10}, {-10, 10, 10}, {0, 10, 0}, {10, 10, 10}},
       .faces = {{0, 1, 4}, {0, 4, 3}, {1, 2, 5}, {1, 5, 4}}}};
  CHECK(sut.nearest({0, 0, 1}, 5)->signed_distance_mm > 0);
  CHECK(sut.nearest({0, 0, -1}, 5)->signed_distance_mm < 0);
  CHECK(sut.nearest({0.3, 0, -1}, 5)->signed_distance_mm < 0);
}

TEST(Measure, CloudErrorHasTheFiguresOfItsDistances) {
  const ReferenceSurface surface{ball(Vec3::Zero())};
  cloud::PointCloud cloud;
  std::normal_distribution<double> normal;
  for (int i = 0; i < 4000; ++i) {
    const Vec3 n = Vec3(normal(random), normal(random), normal(random)).normalized();
    cloud.points.push_back(((k_radius_mm + (i % 4 == 0 ? -0.3 : 0.1)) * n).cast<float>());
  }
  cloud.points.push_back({0, 0, 90});
  const CloudError sut = cloud_error(cloud, surface);
  DOUBLES_EQUAL(0.0, sut.mean_mm, k_facet_mm);
  DOUBLES_EQUAL(std::sqrt(0.75 * 0.01 + 0.25 * 0.09), sut.rms_mm, k_facet_mm);
  DOUBLES_EQUAL(0.1, sut.mean_positive_mm, k_facet_mm);
  DOUBLES_EQUAL(-0.3, sut.mean_negative_mm, k_facet_mm);
  DOUBLES_EQUAL(0.1, sut.max_mm, k_facet_mm);
  LONGS_EQUAL(1, sut.points_far);
}

TEST(Measure, AlignmentFindsTheMotion) {
  // A box corner fixes all six directions.
  const ReferenceSurface surface{
      {.vertices = {{0, 0, 0}, {40, 0, 0}, {40, 40, 0}, {0, 40, 0}, {0, 0, 40}, {40, 0, 40}, {0, 40, 40}},
       .faces = {{0, 1, 2}, {0, 2, 3}, {0, 4, 5}, {0, 5, 1}, {0, 3, 6}, {0, 6, 4}}}};
  const SE3 T = geometry::exp_se3((Twist() << 0.3, -0.2, 0.4, 0.01, -0.02, 0.015).finished());
  cloud::PointCloud cloud;
  std::uniform_real_distribution<double> inside(2, 38);
  for (int i = 0; i < 3000; ++i) {
    Vec3 p(inside(random), inside(random), inside(random));
    p[i % 3] = 0;
    cloud.points.push_back((T * p).cast<float>());
  }
  const CloudError sut = cloud_error_aligned(cloud, surface);
  CHECK(sut.rms_mm < 1e-4);
  TRANSFORMS_EQUAL(T.inverse(), sut.T_surface_cloud, 1e-3, 1e-4);
}

TEST(Measure, LineErrorOfTwoCirclesIsTheDifferenceOfTheirRadii) {
  const LineError sut = line_error(circle(50.2, 700, 0.1), circle(50, 900));
  DOUBLES_EQUAL(0.2, sut.mean_mm, 0.002);  // chords of 900 points lie 0.0006 mm inside
  DOUBLES_EQUAL(0.2, sut.max_mm, 0.002);
  DOUBLES_EQUAL(1.0, sut.complete, 0);
}

TEST(Measure, MissingStretchShowsInCompletenessAndMaximum) {
  cloud::ClosedLine half = circle(50, 1000);
  half.points.resize(501);  // closed by a chord through the middle
  const LineError sut = line_error(half, circle(50, 1000));
  CHECK(sut.max_mm > 45);
  // 1 mm of sagitta is still complete: beyond each end acos(49/50) of arc is no more.
  CHECK(sut.complete > 0.49 && sut.complete < 0.55);
}

TEST(Measure, NormalErrorIsTheAngleToTheWallAboveTheLine) {
  // An upright cylinder of facets: the wall's normal is level; the result's leans by 2 degrees.
  cloud::TriangleMesh tube;
  constexpr std::uint32_t k_sides = 720;
  for (std::uint32_t i = 0; i < k_sides; ++i) {
    const double a = 2 * std::numbers::pi * i / k_sides;
    for (const float z : {0.F, 40.F})
      tube.vertices.push_back(
          {static_cast<float>(50 * std::cos(a)), static_cast<float>(50 * std::sin(a)), z});
    const std::uint32_t b = 2 * i, c = 2 * ((i + 1) % k_sides);
    tube.faces.push_back({b, c, c + 1});
    tube.faces.push_back({b, c + 1, b + 1});
  }
  cloud::ClosedLine line = circle(50, 300);
  const double lean_rad = 2 * std::numbers::pi / 180;
  for (auto& p : line.points) p.normal = std::cos(lean_rad) * p.normal + std::sin(lean_rad) * Vec3::UnitZ();
  const auto sut = normal_error_deg(line, ReferenceSurface{tube}, Vec3::UnitZ());
  CHECK(sut.has_value());
  DOUBLES_EQUAL(2.0, *sut, 0.05);  // facets of 0.5 degrees turn level normals by at most 0.25
}

TEST(Measure, QuantileIsLinearBetweenRanks) {
  DOUBLES_EQUAL(1, quantile({1, 2, 3, 4}, 0), 0);
  DOUBLES_EQUAL(2.5, quantile({1, 2, 3, 4}, 0.5), 1e-12);
  DOUBLES_EQUAL(4, quantile({1, 2, 3, 4}, 1), 0);
}

}  // namespace biteline::evaluation
