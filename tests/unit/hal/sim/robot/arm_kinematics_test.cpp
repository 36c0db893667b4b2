// SPDX-License-Identifier: MIT
#include "hal/sim/robot/arm_kinematics.hpp"

#include <CppUTest/TestHarness.h>

#include "hal/sim/shoe/random.hpp"
#include "tests/support/transforms.hpp"

namespace biteline::sim {

TEST_GROUP(ArmKinematics) {
  ArmKinematics sut = *ArmKinematics::named("ur5e");
};

TEST(ArmKinematics, StretchedOutTheFlangeStandsWhereTheLengthsSay) {
  // All joints 0: the arm lies along -x; d4 and d6 point along -y, d5 down.
  const SE3 T = sut.T_base_flange(JointVector::Zero());
  DOUBLES_EQUAL(-(425 + 392.2), T.translation().x(), 1e-9);
  DOUBLES_EQUAL(-(133.3 + 99.6), T.translation().y(), 1e-9);
  DOUBLES_EQUAL(162.5 - 99.7, T.translation().z(), 1e-9);
}

TEST(ArmKinematics, JointsNearComeBackToTheJointsThatMadeThePose) {
  Random random(4);
  for (int i = 0; i < 200; ++i) {
    JointVector q_rad, near_rad;
    q_rad << random.uniform({-3, 3}), random.uniform({-2, -0.6}), random.uniform({0.6, 2.2}),
        random.uniform({-2, 0}), random.uniform({-2.2, -0.7}), random.uniform({-3, 3});
    for (int k = 0; k < 6; ++k) near_rad[k] = q_rad[k] + random.uniform({-0.05, 0.05});
    const auto found = sut.joints_near(sut.T_base_flange(q_rad), near_rad);
    CHECK(found.has_value());
    DOUBLES_EQUAL(0, (*found - q_rad).norm(), 1e-5);
  }
}

TEST(ArmKinematics, AnywhereFindsAPostureThatReachesAndSaysWhenThereIsNone) {
  const SE3 T = geometry::make_se3(Eigen::Quaterniond(Eigen::AngleAxisd(3.0, Vec3(1, 0.1, 0).normalized())),
                                   {-400, 150, 250});
  const auto found = sut.joints_anywhere(T);
  CHECK(found.has_value());
  TRANSFORMS_EQUAL(T, sut.T_base_flange(*found), 1e-3, 1e-6);
  SE3 far = T;
  far.translation().x() = -1500;
  CHECK_FALSE(sut.joints_anywhere(far).has_value());
}

TEST(ArmKinematics, UnknownArmsAreNoArms) {
  CHECK_FALSE(ArmKinematics::named("ur99").has_value());
}

}  // namespace biteline::sim
