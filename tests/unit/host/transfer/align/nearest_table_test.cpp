// SPDX-License-Identifier: MIT
#include "host/transfer/align/nearest_table.hpp"

#include <CppUTest/TestHarness.h>

#include <cfenv>
#include <limits>
#include <random>

namespace biteline::transfer {

TEST_GROUP(NearestTable) {
  std::mt19937 random{5};
  std::uniform_real_distribution<float> unit{-1, 1};
  Surfels surfels;

  void setup() override {
    surfels.pitch_mm = 2;
    for (int i = 0; i < 3000; ++i) {
      const Eigen::Vector3f p{60 * unit(random), 40 * unit(random), 0};
      surfels.positions.emplace_back(p.x(), p.y(), 0.01F * p.x() * p.x());
      surfels.normals.emplace_back(Eigen::Vector3f::UnitZ());
    }
  }

  float brute_force_mm(const Eigen::Vector3f& point) const {
    float best = 1e9F;
    for (const Eigen::Vector3f& p : surfels.positions) best = std::min(best, (p - point).norm());
    return best;
  }
};

TEST(NearestTable, FarStrayPointsCostCellsAndNeitherMemoryNorBounds) {
  for (const Eigen::Vector3f& stray :
       {Eigen::Vector3f{1e5F, 0, 0}, Eigen::Vector3f{1e5F, -1e5F, 0}, Eigen::Vector3f{-1e5F, 1e5F, 1e5F}}) {
    setup();
    surfels.positions.push_back(stray);
    surfels.normals.emplace_back(Eigen::Vector3f::UnitZ());
    const NearestTable sut{surfels, 10};
    CHECK(sut.near(stray) != NearestTable::k_none);
    CHECK(sut.near({3e38F, 0, 0}) == NearestTable::k_none);
  }
}

TEST(NearestTable, PointsThatNoReaderLetsThroughMakeAnEmptyTable) {
  for (const float far_mm : {1e9F, 1e19F, 3e38F, std::numeric_limits<float>::infinity()}) {
    surfels.positions.push_back({far_mm, -far_mm, 0});
    surfels.normals.emplace_back(Eigen::Vector3f::UnitZ());
    CHECK(NearestTable(surfels, 10).near({0, 0, 0}) == NearestTable::k_none);
  }
  std::feclearexcept(FE_ALL_EXCEPT);  // raised on purpose
}

TEST(NearestTable, AnswerIsAsNearAsTheNearestUpToACell) {
  const NearestTable sut{surfels, 10};
  for (int i = 0; i < 2000; ++i) {
    const Eigen::Vector3f point{60 * unit(random), 40 * unit(random), 18 + 26 * unit(random)};
    const float truth_mm = brute_force_mm(point);
    const std::uint32_t found = sut.near(point);
    if (truth_mm < 10) {
      CHECK(found != NearestTable::k_none);
      // The query lies within half a cell's diagonal (1.73 mm) of the cell's centre: twice that at most, and
      // what a wave that only ever hands on one surfel may miss.
      CHECK((surfels.positions[found] - point).norm() <= truth_mm + 4);
    }
    if (truth_mm > 10 + 4) CHECK(found == NearestTable::k_none);
  }
}

TEST(NearestTable, FarAwayAndBesideTheBoxIsNone) {
  const NearestTable sut{surfels, 10};
  CHECK(sut.near({1e6F, 0, 0}) == NearestTable::k_none);
  CHECK(sut.near({0, 0, -1e6F}) == NearestTable::k_none);
}

TEST(NearestTable, OneStrayPointFarAwayDoesNotTakeTheMemory) {
  surfels.positions.emplace_back(50000, 50000, 50000);
  surfels.normals.emplace_back(Eigen::Vector3f::UnitZ());
  const NearestTable sut{surfels, 10};
  CHECK(sut.near({50000, 50000, 50000}) == 3000);
}

TEST(NearestTable, NoSurfelsNoAnswer) {
  CHECK(NearestTable(Surfels{}, 5).near({0, 0, 0}) == NearestTable::k_none);
}

}  // namespace biteline::transfer
