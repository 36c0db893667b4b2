// SPDX-License-Identifier: MIT
#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <array>
#include <random>
#include <set>

#include "host/bite_line/published/neighbour_search.hpp"

namespace biteline::published {

TEST_GROUP(NeighbourGrid){static std::vector<Eigen::Vector3f> cloud(std::size_t count){std::mt19937 random{7};
std::uniform_real_distribution<float> place{-8.0F, 12.0F};
std::vector<Eigen::Vector3f> points(count);
for (Eigen::Vector3f& p : points) p = {place(random), 0.3F * place(random), place(random) + 100.0F};
return points;
}  // namespace biteline::published
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
  NeighbourSearch search{sut};
  for (const float radius : {0.4F, 1.0F, 2.7F}) {  // within one cell, one cell, several
    for (std::uint32_t i = 0; i < sut.size(); i += 37) {
      const std::span<const std::uint32_t> hits = search.within(i, radius);
      std::set<std::uint32_t> expected;
      for (std::uint32_t k = 0; k < sut.size(); ++k) {
        if ((at(sut, k) - at(sut, i)).squaredNorm() <= radius * radius) expected.insert(k);
      }
      const std::set<std::uint32_t> actual(hits.begin(), hits.end());
      CHECK(expected == actual);
      LONGS_EQUAL(actual.size(), hits.size());
    }
  }
}

TEST(NeighbourGrid, NearestEqualsBruteForceEvenFarBeyondOneCell) {
  const auto points = cloud(1500);
  const NeighbourGrid sut{points, {.cell_mm = 0.5F}};
  NeighbourSearch search{sut};
  for (std::uint32_t i = 0; i < sut.size(); i += 41) {
    const NeighbourSearch::Nearest nearest = search.nearest(i, 20);
    std::vector<float> all;
    for (std::uint32_t k = 0; k < sut.size(); ++k) all.push_back((at(sut, k) - at(sut, i)).squaredNorm());
    std::sort(all.begin(), all.end());
    LONGS_EQUAL(20, std::set(nearest.index.begin(), nearest.index.end()).size());
    DOUBLES_EQUAL(std::sqrt(all[19]), nearest.farthest_mm, 1e-5);
    for (const std::uint32_t k : nearest.index)
      CHECK((at(sut, k) - at(sut, i)).squaredNorm() < all[19] + 1e-5F);
  }
}

TEST(NeighbourGrid, EquallyFarNeighboursFillUpWhatNearerOnesLeave) {
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 900; ++i) {
    const int row = i / 30;
    points.emplace_back(static_cast<float>(i % 30), static_cast<float>(row), 0.0F);
  }
  const NeighbourGrid sut{points, {.cell_mm = 2.0F}};
  NeighbourSearch search{sut};
  const auto middle = static_cast<std::uint32_t>(
      std::find(sut.order().begin(), sut.order().end(), 15U * 30 + 15) - sut.order().begin());
  // Itself, four at 1 and four at the root of 2; two of the four at 2.
  const NeighbourSearch::Nearest nearest = search.nearest(middle, 11);
  std::array<int, 5> found{};
  for (const std::uint32_t k : nearest.index)
    ++found.at(static_cast<std::size_t>((at(sut, k) - at(sut, middle)).squaredNorm()));
  LONGS_EQUAL(1, found[0]);
  LONGS_EQUAL(4, found[1]);
  LONGS_EQUAL(4, found[2]);
  LONGS_EQUAL(2, found[4]);
  DOUBLES_EQUAL(2.0, nearest.farthest_mm, 1e-6);
}

TEST(NeighbourGrid, AskingForMoreThanThereIsGivesAll) {
  const auto points = cloud(5);
  const NeighbourGrid sut{points, {.cell_mm = 1.0F}};
  LONGS_EQUAL(5, NeighbourSearch{sut}.nearest(0, 20).index.size());
}

}  // namespace biteline::published
