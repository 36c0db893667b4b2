// SPDX-License-Identifier: MIT
#include "host/transfer/align/rim.hpp"

#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <random>

namespace biteline::transfer {

TEST_GROUP(Rim) {
  std::mt19937 random{13};

  /// A wall standing upright, 60 mm long, profiles 1.1 mm apart, points 0.1 mm apart; its top edge rises by
  /// 0.1 mm per mm.
  std::vector<Eigen::Vector3f> slanted_wall(bool with_hole = false) {
    std::normal_distribution<float> noise_mm{0, 0.01F};
    std::vector<Eigen::Vector3f> points;
    for (float x = 0; x < 60; x += 1.1F) {
      for (float z = 0; z < 25 + 0.1F * x; z += 0.1F) {
        if (with_hole && x > 20 && x < 30 && z > 8 && z < 16) continue;
        points.emplace_back(x, noise_mm(random), z);
      }
    }
    std::shuffle(points.begin(), points.end(), random);
    return points;
  }
  static Rim rim(const cloud::PointCloud& cloud) {
    return rim_of(cloud, surfels_of(cloud.points, 2));
  }
  static Rim rim(const std::vector<Eigen::Vector3f>& points) {
    cloud::PointCloud cloud;
    cloud.points = points;
    return rim(cloud);
  }
};

// The highest of points 0.1 mm apart, of one or two profiles up to 1 mm aside on a slope of 0.1.
constexpr float k_low_mm = 0.2F, k_high_mm = 0.1F;

TEST(Rim, IsWhereTheSurfaceEndsUpwards) {
  const Rim sut = rim(slanted_wall());
  CHECK(sut.size() >= 26);
  for (const Eigen::Vector3f& p : sut.positions) {
    const float end_mm = 25 + 0.1F * p.x();
    CHECK(p.z() < end_mm + k_high_mm && p.z() > end_mm - k_low_mm);
  }
}

TEST(Rim, AcrossIsAtRightAnglesToTheEdgeAndInTheSurface) {
  for (const Eigen::Vector3f& across : rim(slanted_wall()).across) {
    DOUBLES_EQUAL(0.0F, across.y(), 0.1F);
    DOUBLES_EQUAL(-0.1F, across.x(), 0.1F);
    CHECK(across.z() > 0.9F);
  }
}

TEST(Rim, AHoleInTheWallHasNoUpperEnd) {
  for (const Eigen::Vector3f& p : rim(slanted_wall(true)).positions) CHECK(p.z() > 20);
}

TEST(Rim, StrayPointsAboveDoNotMoveIt) {
  std::vector<Eigen::Vector3f> points = slanted_wall();
  for (float x = 1; x < 60; x += 5) {
    points.emplace_back(x, 0.0F, 26.5F + 0.1F * x);
    points.emplace_back(x, 0.0F, 27.0F + 0.1F * x);
  }
  for (const Eigen::Vector3f& p : rim(points).positions) CHECK(p.z() < 25 + 0.1F * p.x() + k_high_mm);
}

TEST(Rim, WhatEndsWithTheCamerasViewIsNone) {
  std::normal_distribution<float> noise_mm{0, 0.01F};
  cloud::PointCloud scan;
  for (std::uint32_t profile = 0; profile < 55; ++profile) {
    for (std::uint16_t column = 0; column < 250; ++column) {
      scan.points.emplace_back(1.1F * static_cast<float>(profile), noise_mm(random),
                               0.1F * static_cast<float>(column));
      scan.profile.push_back(profile);
      scan.column.push_back(column);
    }
  }
  CHECK(rim(scan.points).size() > 0);
  LONGS_EQUAL(0, rim(scan).size());
  // A few profiles that see farther: the others end where the surface does.
  for (std::size_t i = 0; i < scan.size(); ++i) {
    if (scan.profile[i] >= 50) scan.column[i] = static_cast<std::uint16_t>(scan.column[i] + 40);
  }
  CHECK(rim(scan).size() > 0);
}

TEST(Rim, TooShortARimIsNone) {
  std::vector<Eigen::Vector3f> points = slanted_wall();
  std::erase_if(points, [](const Eigen::Vector3f& p) { return p.x() > 15; });
  CHECK(rim(points).size() == 0);
}

TEST(Rim, WhereAPieceEndsThereIsNone) {
  // Beyond x = 50 mm the view cuts the wall 3 mm below its end: the last column.
  constexpr float k_piece_mm = 50;
  cloud::PointCloud cloud;
  for (const Eigen::Vector3f& p : slanted_wall()) {
    const float below_mm = 25 + 0.1F * p.x() - p.z();
    const bool cut = p.x() > k_piece_mm;
    if (cut && below_mm < 3) continue;
    cloud.points.push_back(p);
    cloud.profile.push_back(static_cast<std::uint32_t>(p.x() / 1.1F));
    cloud.column.push_back(p.z() < 1 ? 10 : cut && below_mm < 3.2F ? 90 : 50);
  }
  const Rim sut = rim(cloud);
  CHECK(sut.size() > 0);
  // A neighbour lies two millimetres and more beyond each.
  for (const Eigen::Vector3f& p : sut.positions) CHECK(p.x() < k_piece_mm - 1.9F && p.x() > 1.9F);
}

}  // namespace biteline::transfer
