// SPDX-License-Identifier: MIT
#include "host/robot/path/checks/obstacles.hpp"

#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <random>
#include <string>

#include "host/robot/kinematics/chain.hpp"
#include "tests/unit/host/robot/path/made_line.hpp"

namespace biteline::path {

using kinematics::Capsule;

TEST_GROUP(Obstacles) {
  std::mt19937_64 random{41};
  std::uniform_real_distribution<double> coordinate{-100, 100};
  Vec3 point() {
    return {coordinate(random), coordinate(random), coordinate(random)};
  }
};

TEST(Obstacles, CapsuleDistanceMatchesDenseSampling) {
  for (int i = 0; i < 200; ++i) {
    const Capsule a{.a = point(), .b = i % 7 == 0 ? Vec3(point()) : point(), .radius_mm = 5};
    Capsule b{.a = point(), .b = point(), .radius_mm = 8};
    if (i % 5 == 0) b.b = b.a + 2 * (a.b - a.a);  // parallel
    if (i % 11 == 0) b.b = b.a;                   // a sphere
    constexpr int k_samples = 400;
    double nearest_mm = 1e9;
    for (int s = 0; s <= k_samples; ++s) {
      const Vec3 p = a.a + (a.b - a.a) * s / k_samples;
      const Vec3 d = b.b - b.a;
      const double t = d.squaredNorm() > 0 ? std::clamp((p - b.a).dot(d) / d.squaredNorm(), 0.0, 1.0) : 0.0;
      nearest_mm = std::min(nearest_mm, (p - b.a - t * d).norm());
    }
    // Segments up to 350 mm in 400 parts: the nearest sample is within 0.45 mm of the nearest point.
    DOUBLES_EQUAL(nearest_mm - 13, distance_mm(a, b), 0.5);
    DOUBLES_EQUAL(distance_mm(a, b), distance_mm(b, a), 1e-9);
  }
}

TEST(Obstacles, ToolInTheTableAndInTheShoeAreNamed) {
  const kinematics::ArmModel arm = *kinematics::arm_model("UR5e");
  Tool tool;
  tool.T_flange_tcp.translation() = Vec3{0, 0, 150};
  kinematics::Joints q_rad;
  q_rad << 0.0, -1.3, 1.8, -2.0, -1.57, 0.0;
  const auto frames = kinematics::joint_frames(arm, q_rad);
  const Vec3 tip = frames.back() * tool.T_flange_tcp.translation();

  const CollisionModel high_table{arm, tool, {.table_z_mm = tip.z() + 60, .shoe_points = {}}};
  CHECK(std::string{high_table.clearance(frames, 50).what}.find("table") != std::string::npos);
  CHECK(high_table.clearance(frames, 50).mm < 0);
  const Vec3 in_tool = frames.back() * Vec3{0, 0, 70};
  const CollisionModel shoe{arm, tool, {.table_z_mm = -1000, .shoe_points = {in_tool}, .shoe_spacing_mm = 0}};
  STRCMP_EQUAL("tool and shoe", shoe.clearance(frames, 50).what);
  DOUBLES_EQUAL(-tool.body_radius_mm, shoe.clearance(frames, 50).mm, 1e-6);
  const CollisionModel free{arm, tool, {.table_z_mm = -1000, .shoe_points = {tip + Vec3{0, 0, -300}}}};
  CHECK(free.clearance(frames, 20).mm >= 20);
}

TEST(Obstacles, GuessedShoeStandsOnTheTableAndIsFilled) {
  const Surroundings s = surroundings_of_line(test::made_line(), {}, 10);
  double lowest = 1e9, highest = -1e9;
  int near_axis = 0;
  for (const Vec3& p : s.shoe_points) {
    lowest = std::min(lowest, p.z());
    highest = std::max(highest, p.z());
    if ((p - Vec3{540, -60, p.z()}).norm() < 15) ++near_axis;
  }
  DOUBLES_EQUAL(10, lowest, 1e-9);
  CHECK(highest > 160);
  CHECK(near_axis > 3);
}

}  // namespace biteline::path
