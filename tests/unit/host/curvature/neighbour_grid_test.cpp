// SPDX-License-Identifier: MIT
#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <random>
#include <set>

#include "host/curvature/neighbour_grid.hpp"

namespace biteline::curvature {

TEST_GROUP(NeighbourGrid){static std::vector<Eigen::Vector3f> cloud(std::size_t count){std::mt19937 random{7};
std::uniform_real_distribution<float> place{-8.0F, 12.0F};
std::vector<Eigen::Vector3f> points(count);
for (Eigen::Vector3f& p : points) p = {place(random), 0.3F * place(random), place(random) + 100.0F};
return points;
}  // namespace biteline::curvature
static Eigen::Vector3f at(const NeighbourGrid& grid, std::uint32_t i) {
  return {grid.x()[i], grid.y()[i], grid.z()[i]};
}
}
;

TEST(NeighbourGrid, EveryPointIsThereOnce) {
  const auto points = cloud(3000);
  const NeighbourGrid sut{points, {.cell_mm = 1.3F}};
  std::set<std::uint32_t> seen;
  for (std::uint32_t i = 0; i < sut.size(); ++i) {
    CHECK((at(sut, i) - points[sut.order()[i]]).norm() == 0.0F);
    seen.insert(sut.order()[i]);
  }
  LONGS_EQUAL(points.size(), seen.size());
}

TEST(NeighbourGrid, RadiusSearchEqualsBruteForce) {
  const auto points = cloud(2000);
  const NeighbourGrid sut{points, {.cell_mm = 1.0F}};
  for (const float radius : {0.4F, 1.0F, 2.7F}) {  // within one cell, one cell, several
    for (std::uint32_t i = 0; i < sut.size(); i += 37) {
      std::vector<NeighbourGrid::Hit> hits;
      sut.within(i, radius, hits);
      std::set<std::uint32_t> expected;
      for (std::uint32_t k = 0; k < sut.size(); ++k) {
        if ((at(sut, k) - at(sut, i)).squaredNorm() <= radius * radius) expected.insert(k);
      }
      std::set<std::uint32_t> actual;
      for (const auto& hit : hits) actual.insert(hit.index);
      CHECK(expected == actual);
      LONGS_EQUAL(actual.size(), hits.size());
    }
  }
}

TEST(NeighbourGrid, NearestEqualsBruteForceEvenFarBeyondOneCell) {
  const auto points = cloud(1500);
  const NeighbourGrid sut{points, {.cell_mm = 0.5F}};
  for (std::uint32_t i = 0; i < sut.size(); i += 41) {
    std::vector<NeighbourGrid::Hit> hits;
    const float farthest = sut.nearest(i, 20, hits);
    std::vector<float> all;
    for (std::uint32_t k = 0; k < sut.size(); ++k) all.push_back((at(sut, k) - at(sut, i)).squaredNorm());
    std::sort(all.begin(), all.end());
    LONGS_EQUAL(20, hits.size());
    DOUBLES_EQUAL(std::sqrt(all[19]), farthest, 1e-5);
  }
}

TEST(NeighbourGrid, AskingForMoreThanThereIsGivesAll) {
  const auto points = cloud(5);
  const NeighbourGrid sut{points, {.cell_mm = 1.0F}};
  std::vector<NeighbourGrid::Hit> hits;
  (void)sut.nearest(0, 20, hits);
  LONGS_EQUAL(5, hits.size());
}

}  // namespace biteline::curvature
