// SPDX-License-Identifier: MIT
#include "host/robot/path/timing.hpp"

#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <cmath>

namespace biteline::path {
namespace {

/// A straight way of `count` points 2 mm apart on the line, joint 1 turning `rad_per_mm`.
struct Way {
  ToolPath path;
  JointPath joints;
};
Way straight(std::size_t count, double rad_per_mm) {
  Way way;
  for (std::size_t i = 0; i < count; ++i) {
    ToolPoint p{.T_base_tcp = SE3::Identity(),
                .segment = Segment::Line,
                .arc_mm = 2.0 * static_cast<double>(i),
                .curvature_per_mm = 0,
                .line_base = Vec3::Zero()};
    p.T_base_tcp.translation().x() = p.arc_mm;
    way.path.points.push_back(p);
    kinematics::Joints q_rad = kinematics::Joints::Zero();
    q_rad[0] = rad_per_mm * p.arc_mm;
    way.joints.q_rad.push_back(q_rad);
    way.joints.turn_rad.push_back(0);
  }
  return way;
}

}  // namespace

TEST_GROUP(Timing) {
  kinematics::ArmModel arm = *kinematics::arm_model("UR5e");
  Motion motion{.speed_mm_s = 100, .acceleration_mm_s2 = 500};
};

TEST(Timing, RampsUpCruisesAndStops) {
  const Way way = straight(201, 0);
  const Timing t = time_path(arm, way.path, way.joints, motion);
  DOUBLES_EQUAL(0, t.speed_mm_s.front(), 0);
  DOUBLES_EQUAL(0, t.speed_mm_s.back(), 0);
  DOUBLES_EQUAL(100, t.speed_mm_s[100], 1e-9);
  // 400 mm: two ramps of 0.2 s over 10 mm each, 380 mm at 100 mm/s.
  DOUBLES_EQUAL(0.4 + 3.8, t.time_s.back(), 1e-6);
}

TEST(Timing, CurvesAreTakenAtTheSpeedTheirRadiusAllows) {
  Way way = straight(201, 0);
  for (std::size_t i = 90; i < 110; ++i) way.path.points[i].curvature_per_mm = 0.5;
  motion.cross_acceleration_mm_s2 = 450;
  const Timing t = time_path(arm, way.path, way.joints, motion);
  DOUBLES_EQUAL(std::sqrt(450 / 0.5), t.speed_mm_s[100], 1e-9);
  for (std::size_t i = 0; i + 1 < 201; ++i) {
    const double a = (std::pow(t.speed_mm_s[i + 1], 2) - std::pow(t.speed_mm_s[i], 2)) / 4;
    CHECK(std::abs(a) <= motion.acceleration_mm_s2 * 1.0001);
  }
}

TEST(Timing, JointsKeepTheirShareOfTheirSpeed) {
  const Way way = straight(201, 0.05);
  motion.joint_speed_ratio = 0.5;
  const Timing t = time_path(arm, way.path, way.joints, motion);
  DOUBLES_EQUAL(0.5 * arm.limits.speed_rad_s[0] / 0.05, t.speed_mm_s[100], 1e-6);
  const JointAcceleration worst = worst_acceleration(arm, way.path, way.joints, t);
  CHECK(worst.ratio <= 1.0);
}

TEST(Timing, WhatABendLeavesOfAJointIsForSpeedingUpAndNoMore) {
  Way way = straight(401, 0.01);
  // Joint 2 swings to and fro: the most of its bend is 1 rad/s2 at 100 mm/s.
  constexpr double k_swing_mm = 40;
  for (std::size_t i = 0; i < way.joints.q_rad.size(); ++i) {
    const double phase = way.path.points[i].arc_mm / k_swing_mm;
    way.joints.q_rad[i][1] = 0.4 * std::sin(phase);
  }
  motion.speed_mm_s = 400;
  motion.acceleration_mm_s2 = 5000;
  motion.joint_speed_ratio = 1;
  const Timing t = time_path(arm, way.path, way.joints, motion);
  const JointAcceleration worst = worst_acceleration(arm, way.path, way.joints, t);
  CHECK(worst.ratio <= 1.1);
  // Nine tenths of the limit where the swing turns.
  const double fastest_mm_s =
      std::sqrt(0.9 * arm.limits.acceleration_rad_s2[1] / (0.4 / (k_swing_mm * k_swing_mm)));
  CHECK(*std::max_element(t.speed_mm_s.begin(), t.speed_mm_s.end()) >= 0.98 * fastest_mm_s);
}

TEST(Timing, AStraightWayLastsAsLongAsAControllerTakes) {
  // 12 mm slowly, with a single point between, and 40 mm fast from stop to stop.
  Way way = straight(8, 0);
  const double arcs_mm[] = {0, 10, 20, 30, 40, 46, 52, 72};
  for (std::size_t i = 0; i < 8; ++i) {
    ToolPoint& point = way.path.points[i];
    point.segment = i < 6 ? Segment::Approach : Segment::Line;
    point.arc_mm = arcs_mm[i];
    point.T_base_tcp.translation().x() = std::min(arcs_mm[i], 52.0);
    point.T_base_tcp.translation().y() = std::max(arcs_mm[i] - 52, 0.0);
  }
  motion = {.speed_mm_s = 100,
            .acceleration_mm_s2 = 1000,
            .approach_mm = 12,
            .approach_speed_mm_s = 30,
            .transfer_speed_mm_s = 250};
  const Timing t = time_path(arm, way.path, way.joints, motion);
  DOUBLES_EQUAL(2 * std::sqrt(0.040 / 1.0), t.time_s[4], 1e-3);
  DOUBLES_EQUAL(12.0 / 30 + 0.03, t.time_s[6] - t.time_s[4], 1e-3);
}

TEST(Timing, OnlyTheTipNearTheLineIsSlowOnItsWayIn) {
  Way way = straight(101, 0);
  for (ToolPoint& point : way.path.points) {
    point.segment = Segment::Approach;
    point.line_base = way.path.points.back().T_base_tcp.translation();
  }
  motion.approach_mm = 20;
  motion.approach_speed_mm_s = 30;
  motion.transfer_speed_mm_s = 150;
  const Timing t = time_path(arm, way.path, way.joints, motion);
  DOUBLES_EQUAL(150, t.speed_mm_s[50], 1e-9);
  DOUBLES_EQUAL(30, t.speed_mm_s[95], 1e-9);
}

}  // namespace biteline::path
