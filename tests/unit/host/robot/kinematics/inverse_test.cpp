// SPDX-License-Identifier: MIT
#include "host/robot/kinematics/inverse.hpp"

#include <CppUTest/TestHarness.h>

#include <cmath>
#include <numbers>

#include "tests/support/transforms.hpp"
#include "tests/unit/host/robot/kinematics/arms.hpp"

namespace biteline::kinematics {
namespace {

// The full 100 000 per arm runs in the benchmark; here as many as fit a fraction of a second.
constexpr int k_poses_nominal = 5000;
constexpr int k_poses_calibrated = 500;
// Where the calibration moves the place at which two branches meet: 3 mrad per joint against sin 0.1.
constexpr double k_near_fold = 0.1;

double distance_rad(const Joints& a, const Joints& b) {
  double worst_rad = 0;
  for (int i = 0; i < 6; ++i) worst_rad = std::max(worst_rad, std::abs(nearest_turn(a[i], b[i]) - b[i]));
  return worst_rad;
}

double nearest_rad(const Solutions& solutions, const Joints& q_rad) {
  double best_rad = 1e9;
  for (const Solution& solution : solutions)
    best_rad = std::min(best_rad, distance_rad(solution.q_rad, q_rad));
  return best_rad;
}

}  // namespace

TEST_GROUP(Inverse){};

TEST(Inverse, FindsTheJointsThatMadeThePoseAndEveryBranchMeetsIt) {
  for (const std::string& name : arm_names()) {
    const ArmModel arm = test::arm(name.c_str());
    test::RandomJoints random{21};
    for (int i = 0; i < k_poses_nominal; ++i) {
      const Joints q_rad = random.next();
      const SE3 T = forward(arm, q_rad);
      const Solutions solutions = inverse(arm, T);
      CHECK_TEXT(solutions.size() >= 2 && solutions.size() % 2 == 0, name.c_str());
      // A doubled root (stretched elbow) loses half the digits: 1e-16 becomes 1e-8.
      CHECK_TEXT(nearest_rad(solutions, q_rad) < 1e-5, name.c_str());
      for (const Solution& solution : solutions)
        TRANSFORMS_EQUAL(T, forward(arm, solution.q_rad), 1e-6, 1e-8);
    }
  }
}

TEST(Inverse, BranchesAreDistinct) {
  const ArmModel arm = test::arm("UR5e");
  Joints q_rad;
  q_rad << 0.3, -1.2, 1.1, -0.7, 0.9, 0.2;
  const Solutions solutions = inverse(arm, forward(arm, q_rad));
  CHECK_EQUAL(8U, solutions.size());
  for (std::size_t i = 0; i < 8; ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      CHECK(solutions[i].branch != solutions[k].branch);
      CHECK(distance_rad(solutions[i].q_rad, solutions[k].q_rad) > 0.01);
    }
  }
}

TEST(Inverse, CalibratedArmsAreMetOnTheirOwnChain) {
  for (const char* name : {"UR3e", "UR5e", "UR10e"}) {
    const ArmModel arm = test::calibrated_arm(name, 77);
    test::RandomJoints random{22};
    for (int i = 0; i < k_poses_calibrated; ++i) {
      const Joints q_rad = random.next();
      if (singularity(arm, q_rad).worst() < k_near_fold) continue;
      const SE3 T = forward(arm, q_rad);
      const Solutions solutions = inverse(arm, T);
      CHECK_TEXT(nearest_rad(solutions, q_rad) < 1e-6, name);
      for (const Solution& solution : solutions)
        TRANSFORMS_EQUAL(T, forward(arm, solution.q_rad), 1e-6, 1e-8);
    }
  }
}

TEST(Inverse, WristSingularityTakesTheHintedAngle) {
  const ArmModel arm = test::arm("UR5e");
  Joints q_rad;
  q_rad << 0.3, -1.2, 1.1, -0.7, 0.0, 0.2;
  const SE3 T = forward(arm, q_rad);
  const Solutions solutions = inverse(arm, T, {.q6_hint_rad = 0.2});
  CHECK(nearest_rad(solutions, q_rad) < 1e-5);
  for (const Solution& solution : solutions) TRANSFORMS_EQUAL(T, forward(arm, solution.q_rad), 1e-4, 1e-7);
}

TEST(Inverse, PosesOutOfReachHaveNoSolution) {
  const ArmModel arm = test::arm("UR5e");
  SE3 T = SE3::Identity();
  T.translation() = Vec3{1200, 0, 200};
  CHECK(inverse(arm, T).empty());
  CHECK(inverse(test::calibrated_arm("UR5e", 1), T).empty());
  T.translation() = Vec3{10, 0, 700};  // inside the inner cylinder
  CHECK(inverse(arm, T).empty());
}

TEST(Inverse, NearestTurnCrossesTheSeam) {
  DOUBLES_EQUAL(2 * std::numbers::pi - 0.1, nearest_turn(-0.1, 6.2), 1e-12);
  DOUBLES_EQUAL(-3.2, nearest_turn(2 * std::numbers::pi - 3.2, -3.1), 1e-12);
}

TEST(Inverse, NearestTurnsStayWithinTheLimits) {
  constexpr double k_whole_rad = 2 * std::numbers::pi;
  const ArmModel arm = test::arm("UR10e");
  Joints q_rad, reference_rad;
  q_rad << 0.2, -3, 3, 2, -2, 1;
  reference_rad << 6.25, 3, -3, 2.1, 4, -6.2;
  const Joints sut = nearest_turns(q_rad, reference_rad, arm.limits, 0.1);
  Joints expected_rad;
  // Round the base would be nearer beyond its limit; the elbow never turns round.
  expected_rad << 0.2, k_whole_rad - 3, 3, 2, k_whole_rad - 2, 1 - k_whole_rad;
  DOUBLES_EQUAL(0, (sut - expected_rad).norm(), 1e-9);
  DOUBLES_EQUAL(1, nearest_turns(q_rad, reference_rad, arm.limits, 2)[5], 1e-9);
}

}  // namespace biteline::kinematics
