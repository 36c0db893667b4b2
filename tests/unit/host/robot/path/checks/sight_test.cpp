// SPDX-License-Identifier: MIT
#include "host/robot/path/checks/sight.hpp"

#include <CppUTest/TestHarness.h>

#include <string>

namespace biteline::path {

TEST_GROUP(Sight) {
  // A head goes along an upright wall (y = 0, x from 0 to 100); camera and laser stand 150 mm before it.
  Sight sight{.camera_tcp = {-100, 0, -150}, .laser_tcp = {0, 0, -150}};
  PlannedPath path;
  std::vector<Eigen::Vector3f> shoe;

  void setup() override {
    Mat3 R;
    R << 1, 0, 0, 0, 0, 1, 0, -1, 0;  // tcp: x along the wall, y down, z into it
    for (int mm = 0; mm <= 100; ++mm) {
      SE3 T_base_tcp = SE3::Identity();
      T_base_tcp.linear() = R;
      T_base_tcp.translation() = Vec3{static_cast<double>(mm), 0, 30};
      path.waypoints.push_back({.T_base_tcp = T_base_tcp,
                                .q_rad = kinematics::Joints::Zero(),
                                .segment = Segment::Line,
                                .arc_mm = static_cast<double>(mm),
                                .line_base = T_base_tcp.translation()});
    }
    for (int x = -20; x <= 120; ++x) {
      for (int z = 0; z <= 80; ++z) shoe.emplace_back(static_cast<float>(x), 0.0F, static_cast<float>(z));
    }
  }
  /// A post of 10 mm before the wall.
  void add_post(float x_mm, float y_mm) {
    for (int i = 0; i <= 10; ++i) {
      for (int z = 0; z <= 80; ++z)
        shoe.emplace_back(x_mm + static_cast<float>(i), y_mm, static_cast<float>(z));
    }
  }
};

TEST(Sight, AnOpenWallIsSeen) {
  const Check sut = sight_check(path, sight, Occupancy{shoe, 1});
  CHECK(sut.passed);
  DOUBLES_EQUAL(0.0, sut.value, 1e-12);
}

TEST(Sight, APostBeforeTheWallIsInTheCamerasViewWhereItsRaysCross) {
  // 30 mm before the wall; a ray to the camera goes 2 along it for 3 away, so the post hides x = 70 to 80.
  // The laser's light comes from above the post.
  sight.laser_tcp = {0, -300, -150};
  add_post(50, -30);
  const Check sut = sight_check(path, sight, Occupancy{shoe, 1});
  CHECK_FALSE(sut.passed);
  DOUBLES_EQUAL(11, sut.value, 2);  // the post and a cell on both sides
  STRCMP_CONTAINS("camera", sut.detail.c_str());
  DOUBLES_EQUAL(80, sut.arc_mm, 2.5);
}

TEST(Sight, ThePostAloneInTheLasersLightIsToldAsThat) {
  sight.camera_tcp = {0, 100, -150};  // far below: it looks under the post
  for (int i = 0; i <= 10; ++i) {
    for (int z = 28; z <= 80; ++z)
      shoe.emplace_back(50.0F + static_cast<float>(i), -60.0F, static_cast<float>(z));
  }
  const Check sut = sight_check(path, sight, Occupancy{shoe, 1});
  CHECK_FALSE(sut.passed);
  STRCMP_CONTAINS("laser", sut.detail.c_str());
}

TEST(Sight, NothingIsHiddenByNothing) {
  CHECK(sight_check(path, sight, Occupancy{{}, 1}).passed);
}

}  // namespace biteline::path
