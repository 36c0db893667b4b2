// SPDX-License-Identifier: MIT
#include "hal/sim/render/scene.hpp"

#include <CppUTest/TestHarness.h>

namespace biteline::sim {

namespace {

/// Two squares of 100 mm: one at z = 0, a smaller one at z = 10 over its corner.
SurfaceMesh steps() {
  SurfaceMesh mesh;
  const auto square = [&](float low, float high, float z, SurfaceLook look) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (const auto& corner : {std::array{low, low, z}, std::array{high, low, z}, std::array{high, high, z},
                               std::array{low, high, z}}) {
      mesh.vertices.push_back(corner);
      mesh.looks.push_back(look);
    }
    mesh.triangles.push_back({first, first + 1, first + 2});
    mesh.triangles.push_back({first, first + 2, first + 3});
  };
  square(0, 100, 0, {.diffuse_ratio = 0.5, .glossy = false});
  square(0, 20, 10, {.diffuse_ratio = 0.9, .glossy = true});
  return mesh;
}

}  // namespace

TEST_GROUP(Scene){};

TEST(Scene, FirstHitIsTheNearestSurfaceWithItsNormalTowardsTheRay) {
  const Scene sut = *Scene::build(steps());
  const auto upper = sut.first_hit({5, 8, 100}, -Vec3::UnitZ());
  const auto lower = sut.first_hit({50, 8, 100}, -Vec3::UnitZ());
  CHECK(upper && lower);
  DOUBLES_EQUAL(90, upper->distance_mm, 1e-4);
  DOUBLES_EQUAL(100, lower->distance_mm, 1e-4);
  DOUBLES_EQUAL(1, lower->normal.z(), 1e-6);
  CHECK(upper->look.glossy);
  CHECK_FALSE(lower->look.glossy);
  CHECK_FALSE(sut.first_hit({150, 8, 100}, -Vec3::UnitZ()).has_value());
}

TEST(Scene, SeesPastAndNotThrough) {
  const Scene sut = *Scene::build(steps());
  CHECK(sut.sees({50, 50, 100}, {50, 50, 0}));
  CHECK_FALSE(sut.sees({5, 5, 100}, {5, 5, 0}));
  // From the side the small square hides only what lies behind its edge.
  CHECK(sut.sees({120, 10, 50}, {25, 10, 0}));
  CHECK_FALSE(sut.sees({-80, 10, 50}, {25, 10, 0}));
}

TEST(Scene, RefusesAnEmptyMesh) {
  CHECK_FALSE(Scene::build(SurfaceMesh{}).has_value());
}

}  // namespace biteline::sim
