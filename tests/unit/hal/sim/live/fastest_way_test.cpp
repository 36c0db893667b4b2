// SPDX-License-Identifier: MIT
#include "hal/sim/live/fastest_way.hpp"

#include <CppUTest/TestHarness.h>

#include <cmath>

namespace biteline::sim {

TEST_GROUP(FastestWay) {
  static constexpr double k_step_mm = 1;
  WayLimits limits{
      .joints = ArmKinematics::named("ur10e")->limits(), .speed_mm_s = 1e4, .acceleration_mm_s2 = 1e6};

  template <class Angle>
  static std::vector<JointVector> way_of_last_joint(int samples, Angle angle) {
    std::vector<JointVector> way(static_cast<std::size_t>(samples), JointVector::Zero());
    for (int i = 0; i < samples; ++i) way[static_cast<std::size_t>(i)][5] = angle(i * k_step_mm);
    return way;
  }
  static double duration_s(const std::vector<double>& speed_mm_s) {
    double time_s = 0;
    for (std::size_t i = 1; i < speed_mm_s.size(); ++i)
      time_s += 2 * k_step_mm / (speed_mm_s[i - 1] + speed_mm_s[i]);
    return time_s;
  }
};

TEST(FastestWay, AnEvenTurnTakesTheTimeOfItsJointsTrapezoid) {
  constexpr double k_rad_per_mm = 0.01, k_turn_rad = 4;
  const auto sut =
      fastest_way(way_of_last_joint(401, [](double s) { return k_rad_per_mm * s; }), k_step_mm, limits);
  const double speed = limits.joints.speed_rad_s[5], acceleration = limits.joints.acceleration_rad_s2[5];
  const double least_s = k_turn_rad / speed + speed / acceleration;
  // Some percent of each limit are kept for what happens between samples.
  CHECK_COMPARE(duration_s(sut), >, least_s);
  CHECK_COMPARE(duration_s(sut), <, 1.12 * least_s);
  for (const double v : sut) CHECK_COMPARE(v * k_rad_per_mm, <=, speed);
  DOUBLES_EQUAL(0, sut.front(), 0);
  DOUBLES_EQUAL(0, sut.back(), 0);
}

TEST(FastestWay, WhereTheWayBendsItIsGoneSlowly) {
  // A swing to and fro: at its turning point nothing but the bend counts.
  constexpr double k_waves_per_mm = 0.02, k_swing_rad = 0.5;
  const auto sut =
      fastest_way(way_of_last_joint(315, [](double s) { return k_swing_rad * std::sin(k_waves_per_mm * s); }),
                  k_step_mm, limits);
  const double bend = k_swing_rad * k_waves_per_mm * k_waves_per_mm;
  const double most_mm_s = std::sqrt(limits.joints.acceleration_rad_s2[5] / bend);
  const auto top = static_cast<std::size_t>(1.5708 / k_waves_per_mm);
  CHECK_COMPARE(sut[top], <=, most_mm_s);
  CHECK_COMPARE(sut[top], >, 0.8 * most_mm_s);
}

TEST(FastestWay, TheSpeedAskedForIsNotExceeded) {
  limits.speed_mm_s = 50;
  limits.acceleration_mm_s2 = 100;
  const auto sut = fastest_way(way_of_last_joint(201, [](double s) { return 0.001 * s; }), k_step_mm, limits);
  for (const double v : sut) CHECK_COMPARE(v, <=, 50 + 1e-9);
  // 0.5 s of speeding up and as long of slowing down, 12.5 mm each.
  DOUBLES_EQUAL(2 * 0.5 + 175.0 / 50, duration_s(sut), 0.15);
}

}  // namespace biteline::sim
