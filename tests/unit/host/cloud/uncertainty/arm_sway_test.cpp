// SPDX-License-Identifier: MIT
#include "host/cloud/uncertainty/arm_sway.hpp"

#include <CppUTest/TestHarness.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "hal/sim/shoe/random.hpp"

namespace biteline::uncertainty {
namespace {

constexpr double k_rate_hz = 100, k_lap_s = 3;
constexpr double k_noise_mm = 0.01;

/// A lap round a shoe on a table: of each profile a wall, and below it a piece of the table.
struct Lap {
  std::function<double(double)> up_mm = [](double) { return 0.0; };  ///< the arm's sway over time
  std::function<bool(double)> table_in_view = [](double) { return true; };
  double slope{0};   ///< of the table, along x
  double around{1};  ///< of the way round

  [[nodiscard]] static Vec3 foot(double time_s) {
    const double angle = 2 * std::numbers::pi * time_s / k_lap_s;
    return {700 + 140 * std::cos(angle), 50 * std::sin(angle), 0};
  }
  [[nodiscard]] ArmSway seen() const {
    ArmSway sway;
    sim::Random random{7};
    for (int i = 0; i < around * k_lap_s * k_rate_hz; ++i) {
      const double time_s = i / k_rate_hz;
      const Vec3 foot_mm = foot(time_s);
      const Vec3 outwards = Vec3{foot_mm.x() - 700, foot_mm.y(), 0}.normalized();
      std::vector<Eigen::Vector3f> points;
      if (table_in_view(time_s)) {
        for (double beside_mm = 5; beside_mm > 0; beside_mm -= 0.25) {
          Vec3 point = foot_mm + beside_mm * outwards;
          point.z() = 30 + slope * (point.x() - 700) + up_mm(time_s) + k_noise_mm * random.gaussian();
          points.push_back(point.cast<float>());
        }
      }
      // It leans: nothing of it is level.
      for (double up = 3; up < 60; up += 0.25)
        points.push_back((foot_mm + Vec3{0, 0, 30 + up} - 0.3 * up * outwards).cast<float>());
      sway.add_profile(points, time_s);
    }
    return sway;
  }
};

double swing_mm(double time_s, double sigma_mm) {
  return std::numbers::sqrt2 * sigma_mm * std::sin(2 * std::numbers::pi * 6.3 * time_s);
}

}  // namespace

TEST_GROUP(ArmSway){};

TEST(ArmSway, IsReadOffTheTableAndFollowsTheArm) {
  for (const double sigma_mm : {0.01, 0.02, 0.04, 0.1}) {
    const Lap lap{.up_mm = [=](double time_s) { return swing_mm(time_s, sigma_mm); }};
    const std::optional<ArmMotion> sut = lap.seen().motion();
    CHECK(sut.has_value());
    DOUBLES_EQUAL(sigma_mm, sut->sigma_mm, 0.15 * sigma_mm);
    CHECK_EQUAL(300, sut->profiles);
  }
}

TEST(ArmSway, OfAnArmThatDoesNotSwayLittleIsLeftOfTheNoise) {
  const std::optional<ArmMotion> sut = Lap{}.seen().motion();
  CHECK(sut.has_value());
  CHECK_COMPARE(sut->sigma_mm, <, 0.2 * k_noise_mm);
}

TEST(ArmSway, ATableMayLean) {
  const Lap lap{.up_mm = [](double time_s) { return swing_mm(time_s, 0.02); }, .slope = 0.01};
  const std::optional<ArmMotion> sut = lap.seen().motion();
  CHECK(sut.has_value());
  DOUBLES_EQUAL(0.02, sut->sigma_mm, 0.003);
}

TEST(ArmSway, WhatLiesOnTheTableIsNoSway) {
  // A ruler, for a quarter of a second.
  const Lap lap{.up_mm = [](double time_s) { return swing_mm(time_s, 0.02) + (time_s < 0.25 ? 2.0 : 0.0); }};
  const std::optional<ArmMotion> sut = lap.seen().motion();
  CHECK(sut.has_value());
  DOUBLES_EQUAL(0.02, sut->sigma_mm, 0.005);
}

TEST(ArmSway, APlaceWhereTheArmSwaysMoreSaysSo) {
  const auto shaken = [](double time_s) { return time_s > 1 && time_s < 1.5; };
  const auto up = [&](double time_s) { return swing_mm(time_s, shaken(time_s) ? 0.08 : 0.01); };
  const std::optional<ArmMotion> sut = Lap{.up_mm = up}.seen().motion();
  CHECK(sut.has_value());
  CHECK_COMPARE(sut->sigma_mm_at(Lap::foot(1.25)), >, 0.06);
  CHECK_COMPARE(sut->sigma_mm_at(Lap::foot(2.5)), <, 0.03);
  // Where the table was out of view it may be as bad as at the worst place.
  const Lap part{.up_mm = up, .table_in_view = [](double time_s) { return time_s < 2.2 || time_s > 2.8; }};
  const std::optional<ArmMotion> unseen = part.seen().motion();
  CHECK(unseen.has_value());
  CHECK_COMPARE(unseen->sigma_mm_at(Lap::foot(2.5)), >, 0.06);
}

TEST(ArmSway, IsNotKnownWithoutATableAllTheWayRound) {
  CHECK_FALSE(Lap{.table_in_view = [](double) { return false; }}.seen().motion().has_value());
  // One end of the shoe: its sides are too near to each other to tell sway from a table that leans.
  CHECK_FALSE((Lap{.table_in_view = [](double time_s) { return time_s < 0.1; }}.seen().motion().has_value()));
  CHECK_FALSE((Lap{.around = 0.15}.seen().motion().has_value()));
  CHECK_FALSE(ArmSway{}.motion().has_value());
}

}  // namespace biteline::uncertainty
