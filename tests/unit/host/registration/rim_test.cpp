// SPDX-License-Identifier: MIT
#include "host/registration/rim.hpp"

#include <CppUTest/TestHarness.h>

namespace biteline::registration {

TEST_GROUP(Rim) {
  /// A plane standing upright, 60 profiles 1 mm apart, 120 columns 0.2 mm apart; its top edge rises by 0.1 mm per mm.
  cloud::PointCloud slanted_wall() const {
    cloud::PointCloud cloud;
    for (std::uint32_t profile = 0; profile < 60; ++profile) {
      for (std::uint16_t column = 0; column < 120; ++column) {
        const float z = 0.2F * static_cast<float>(column);
        if (z > 15 + 0.1F * static_cast<float>(profile)) break;
        cloud.points.emplace_back(static_cast<float>(profile), 0.0F, z);
        cloud.profile.push_back(profile);
        cloud.column.push_back(column);
      }
    }
    return cloud;
  }
};

TEST(Rim, IsTheUpperEndOfEachProfile) {
  const Rim sut = rim_of(slanted_wall());
  CHECK(sut.size() >= 55);
  for (const Eigen::Vector3f& p : sut.positions) DOUBLES_EQUAL(15 + 0.1F * p.x() - 0.1F, p.z(), 0.11F);  // half a column
}

TEST(Rim, AcrossIsAtRightAnglesToTheEdgeAndInTheSurface) {
  for (const Eigen::Vector3f& across : rim_of(slanted_wall()).across) {
    DOUBLES_EQUAL(0.0F, across.y(), 1e-4F);
    // Edge points snap to columns of 0.2 mm at 1 mm distance: +-0.1 rad about the true 0.1 rad.
    DOUBLES_EQUAL(0.1F, across.x(), 0.11F);
    CHECK(across.z() < -0.9F);
  }
}

TEST(Rim, SpeckleBeyondTheEdgeIsNoEdge) {
  cloud::PointCloud cloud = slanted_wall();
  cloud::PointCloud speckled;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    speckled.points.push_back(cloud.points[i]);
    speckled.profile.push_back(cloud.profile[i]);
    speckled.column.push_back(cloud.column[i]);
    const bool last = i + 1 == cloud.size() || cloud.profile[i + 1] != cloud.profile[i];
    if (!last || cloud.profile[i] % 3 != 0) continue;
    speckled.points.emplace_back(cloud.points[i].x(), 0.0F, 30.0F);
    speckled.profile.push_back(cloud.profile[i]);
    speckled.column.push_back(140);
  }
  const Rim sut = rim_of(speckled);
  CHECK(sut.size() >= 55);
  for (const Eigen::Vector3f& p : sut.positions) CHECK(p.z() < 22);
}

TEST(Rim, CloudWithoutOrderHasNone) {
  cloud::PointCloud cloud = slanted_wall();
  cloud.profile.clear();
  CHECK(rim_of(cloud).size() == 0);
}

}  // namespace biteline::registration
