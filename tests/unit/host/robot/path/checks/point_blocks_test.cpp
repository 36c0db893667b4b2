// SPDX-License-Identifier: MIT
#include "host/robot/path/checks/point_blocks.hpp"

#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <limits>
#include <random>

namespace biteline::path {

TEST_GROUP(PointBlocks) {
  std::mt19937_64 engine{7};
  double within(double from, double to) {
    return std::uniform_real_distribution<double>{from, to}(engine);
  }
  Vec3 place(double reach_mm) {
    return {within(-reach_mm, reach_mm), within(-reach_mm, reach_mm), within(-reach_mm, reach_mm)};
  }
  /// Point after point.
  static double plainly_mm(const std::vector<Vec3>& points, const kinematics::Capsule& capsule,
                           double enough_mm) {
    double nearest_mm = enough_mm;
    for (const Vec3& p : points) {
      const Vec3 along = capsule.b - capsule.a;
      const double t = std::clamp((p - capsule.a).dot(along) / along.squaredNorm(), 0.0, 1.0);
      nearest_mm = std::min(nearest_mm, (p - capsule.a - t * along).norm() - capsule.radius_mm);
    }
    return nearest_mm;
  }
};

TEST(PointBlocks, TheNearestIsThatOfEveryPointLookedAt) {
  std::vector<Vec3> points;
  for (int i = 0; i < 3000; ++i) points.push_back(place(150));
  const PointBlocks sut{points};
  int near = 0;
  for (int i = 0; i < 500; ++i) {
    const kinematics::Capsule capsule{.a = place(400), .b = place(400), .radius_mm = within(0, 60)};
    const double enough_mm = within(1, 80), expected_mm = plainly_mm(points, capsule, enough_mm);
    DOUBLES_EQUAL(expected_mm, sut.nearest_mm(capsule, enough_mm), 1e-9);
    if (expected_mm < enough_mm) ++near;
  }
  CHECK(near > 100 && near < 500);
}

TEST(PointBlocks, WithoutPointsEverythingIsFar) {
  const kinematics::Capsule capsule{.a = Vec3::Zero(), .b = Vec3::UnitZ(), .radius_mm = 10};
  DOUBLES_EQUAL(20, PointBlocks{{}}.nearest_mm(capsule, 20), 0);
}

TEST(PointBlocks, WhatIsNoPlaceHidesNoOtherPoint) {
  const double no_number = std::numeric_limits<double>::quiet_NaN();
  const PointBlocks sut{{Vec3{no_number, 0, 0}, Vec3{15, 0, 0}, Vec3{1e300, 0, 0}}};
  const kinematics::Capsule capsule{.a = Vec3::Zero(), .b = 10 * Vec3::UnitZ(), .radius_mm = 10};
  DOUBLES_EQUAL(5, sut.nearest_mm(capsule, 20), 1e-12);
}

}  // namespace biteline::path
