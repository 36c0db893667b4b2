// SPDX-License-Identifier: MIT
/// \file What an arm's dynamics do to where it is and to what its controller says.
#include <CppUTest/TestHarness.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "hal/sim/robot/arm.hpp"
#include "hal/sim/robot/ur_values.hpp"

namespace biteline::sim {

namespace {

constexpr double k_turn_rad_s = 0.5;

SensorClock::time_point at_s(double time_s) {
  return SensorClock::time_point{Nanoseconds{std::llround(time_s * 1e9)}};
}

}  // namespace

TEST_GROUP(RealArm) {
  ArmKinematics kinematics = *ArmKinematics::named("ur10e");
  JointVector q_rest_rad = (JointVector() << 0.1, -1.4, 1.7, -1.8, -1.5, 0.2).finished();

  /// One joint turns at an even speed for a second and stops dead.
  void turn(Arm & arm, Eigen::Index joint, double begin_s) const {
    arm.run({.name = "turn",
             .duration_s = 1,
             .q_rad_at =
                 [=, q_rad = q_rest_rad](double time_s) {
                   JointVector turned_rad = q_rad;
                   turned_rad[joint] += k_turn_rad_s * time_s;
                   return turned_rad;
                 }},
            at_s(begin_s));
  }
  /// Of the tip about its rest, along its way, for a second; the arm is not asked about a time before that.
  static std::vector<double> swing_mm(const Arm& arm, double from_s, bool told) {
    std::vector<double> swing;
    for (double t = from_s; t < from_s + 1; t += 0.001) {
      const ArmReal real = arm.real_at(at_s(t));
      swing.push_back((told ? real.T_base_flange_told : real.T_base_flange).translation().y());
    }
    const double rest_mm = arm.real_at(at_s(from_s + 3)).T_base_flange.translation().y();
    for (double& place_mm : swing) place_mm -= rest_mm;
    return swing;
  }
  static double crossings_hz(const std::vector<double>& swing_mm) {
    int first = -1, last = -1, count = 0;
    for (int i = 1; i < static_cast<int>(swing_mm.size()); ++i) {
      if (swing_mm[static_cast<std::size_t>(i)] * swing_mm[static_cast<std::size_t>(i - 1)] >= 0) continue;
      if (first < 0) first = i;
      last = i;
      ++count;
    }
    return count < 3 ? 0 : (count - 1) / (2 * 0.001 * (last - first));
  }
  static double most(const std::vector<double>& swing_mm) {
    double highest = 0;
    for (const double value : swing_mm) highest = std::max(highest, std::abs(value));
    return highest;
  }
};

TEST(RealArm, WithoutDynamicsItIsWhereItIsTold) {
  Arm sut(kinematics, q_rest_rad);
  turn(sut, 0, 10);
  for (double t = 9.9; t < 11.2; t += 0.0137) {
    const ArmReal real = sut.real_at(at_s(t));
    CHECK(real.T_base_flange.matrix() == sut.at(at_s(t)).T_base_flange.matrix());
    CHECK(real.T_base_flange_told.matrix() == sut.at(at_s(t)).T_base_flange.matrix());
  }
}

TEST(RealArm, SwingsAtItsJointsOwnFrequencyAfterAStop) {
  for (const double elastic_hz : {6.0, 8.0}) {
    Arm sut(kinematics, q_rest_rad, {.elastic_hz = elastic_hz});
    (void)sut.real_at(at_s(10));
    turn(sut, 0, 10);
    const auto swing = swing_mm(sut, 11.05, false);
    CHECK(most(swing) > 0.1);
    // A damped swing is slower than the joint's own by less than a percent.
    DOUBLES_EQUAL(JointDynamics::joint_hz(elastic_hz, 0), crossings_hz(swing), 0.03 * elastic_hz);
  }
}

TEST(RealArm, EncodersSeeTheGearsGiveAndNotTheLinks) {
  Arm sut(kinematics, q_rest_rad, {.elastic_hz = 8, .unseen_ratio = 0.3});
  (void)sut.real_at(at_s(10));
  turn(sut, 0, 10);
  const auto told = swing_mm(sut, 11.05, true);
  Arm again(kinematics, q_rest_rad, {.elastic_hz = 8, .unseen_ratio = 0.3});
  (void)again.real_at(at_s(10));
  turn(again, 0, 10);
  const auto real = swing_mm(again, 11.05, false);
  DOUBLES_EQUAL(0.7, most(told) / most(real), 0.01);
}

TEST(RealArm, IsBehindItsTargetByFollowingAndLatency) {
  Arm sut(kinematics, q_rest_rad, {.following_s = 0.010, .latency = Nanoseconds{4'000'000}});
  (void)sut.real_at(at_s(10));
  turn(sut, 0, 10);
  const double behind_rad =
      sut.at(at_s(10.5)).q_rad.value()[0] - sut.real_at(at_s(10.5)).q_told_rad.value()[0];
  DOUBLES_EQUAL(k_turn_rad_s * 0.014, behind_rad, k_turn_rad_s * 0.001);
  DOUBLES_EQUAL(0, (*sut.at(at_s(12)).q_rad - *sut.real_at(at_s(12)).q_told_rad).norm(), 1e-9);
}

TEST(RealArm, AStopLetsTheDrivesRunOnAndComeBack) {
  Arm sut(kinematics, q_rest_rad, common_arm_dynamics());
  (void)sut.real_at(at_s(10));
  turn(sut, 0, 10);
  const SE3 T_before = sut.real_at(at_s(10.499)).T_base_flange;
  sut.stop(at_s(10.5));
  // A stop from half a radian a second: the drives run on by some milliseconds, then come back.
  double farthest_rad = 0;
  const double stopped_rad = sut.at(at_s(10.5)).q_rad.value()[0];
  for (double t = 10.5; t < 11; t += 0.001)
    farthest_rad = std::max(farthest_rad, std::abs(sut.real_at(at_s(t)).q_told_rad.value()[0] - stopped_rad));
  CHECK(farthest_rad > 0.002 && farthest_rad < 0.02);
  CHECK(!T_before.isApprox(sut.real_at(at_s(11)).T_base_flange, 1e-9));
  // The joint rings at 8 Hz; ten seconds on nothing of that is left.
  DOUBLES_EQUAL(stopped_rad, sut.real_at(at_s(20)).q_told_rad.value()[0], 1e-4);
}

TEST(RealArm, JointsThatNobodyTellsAreFollowedFromPoseToPose) {
  Arm sut(kinematics, q_rest_rad, {.following_s = 0.010});
  (void)sut.real_at(at_s(10));
  const SE3 T_from = sut.at(at_s(10)).T_base_flange;
  sut.run({.name = "straight",
           .duration_s = 1,
           .T_base_flange_at = [=](double time_s) -> SE3 {
             return SE3(Eigen::Translation3d(0, 100 * time_s, 0)) * T_from;
           }},
          at_s(10));
  const ArmReal half_way = sut.real_at(at_s(10.5));
  // 100 mm/s and 10 ms: one millimetre behind.
  DOUBLES_EQUAL(T_from.translation().y() + 49, half_way.T_base_flange_told.translation().y(), 0.1);
}

TEST(RealArm, TheControllerTellsTargetAndActualApart) {
  Arm arm(kinematics, q_rest_rad, {.following_s = 0.010, .latency = Nanoseconds{4'000'000}});
  (void)arm.real_at(at_s(10));
  turn(arm, 0, 10);
  UrValues sut(kinematics);
  for (double t = 10.49; t < 10.5; t += 0.002) sut.advance(arm.at(at_s(t)), arm.real_at(at_s(t)), t);
  const auto joint = [&](const char* name) { return std::get<rtde::Vector6>(sut.value_of(name))[0]; };
  DOUBLES_EQUAL(0.014 * k_turn_rad_s, joint("target_q") - joint("actual_q"), 0.002 * k_turn_rad_s);
  DOUBLES_EQUAL(k_turn_rad_s, joint("target_qd"), 1e-6);
  const auto tip = [&](const char* name) {
    const auto pose = std::get<rtde::Vector6>(sut.value_of(name));
    return Vec3(pose[0], pose[1], pose[2]);
  };
  CHECK((tip("target_TCP_pose") - tip("actual_TCP_pose")).norm() > 0.002);  // metres
}

}  // namespace biteline::sim
