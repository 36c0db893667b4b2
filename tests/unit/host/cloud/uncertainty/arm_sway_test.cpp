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
constexpr double k_swing_rad_s = 2 * std::numbers::pi * 6.3;

/// A lap round a shoe on a table: of each profile a wall, and below it a piece of the table.
struct Lap {
  std::function<double(double)> up_mm = [](double) { return 0.0; };  ///< the arm's sway over time
  std::function<bool(double)> table_in_view = [](double) { return true; };
  double slope{0};     ///< of the table, along x
  double around{1};    ///< of the way round
  double ahead_mm{0};  ///< told along x: the arm swings so far, and the table does not show it

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
      SE3 T_base_flange = SE3::Identity();
      T_base_flange.translation() = Vec3{ahead_mm * std::sin(k_swing_rad_s * time_s), 0, 400};
      sway.add_profile(points, {.T_base_flange = T_base_flange, .time_s = time_s});
    }
    return sway;
  }
};

double swing_mm(double time_s, double sigma_mm) {
  return std::numbers::sqrt2 * sigma_mm * std::sin(k_swing_rad_s * time_s);
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

TEST(ArmSway, OutOfViewItFollowsFromTheArmsMotionAndWhatItGives) {
  const Lap lap{.table_in_view = [](double) { return false; }, .ahead_mm = 1};
  const ArmSway seen = lap.seen();
  const std::optional<ArmMotion> sut =
      seen.motion_by({.mm_per_m_s2 = 0.04, .source = ArmSource::EarlierScans});
  CHECK(sut.has_value());
  // A millimetre at 6.3 Hz, of which a cubic over 0.1 s leaves three quarters.
  const double acceleration_m_s2 = 1e-3 * k_swing_rad_s * k_swing_rad_s / std::numbers::sqrt2;
  DOUBLES_EQUAL(0.75 * 0.04 * acceleration_m_s2, sut->sigma_mm, 0.1 * 0.04 * acceleration_m_s2);
  DOUBLES_EQUAL(sut->sigma_mm, sut->sigma_mm_at(Lap::foot(1.5)), 0.1 * sut->sigma_mm);
  CHECK(sut->source == ArmSource::EarlierScans);
  CHECK_EQUAL(0, sut->profiles);
  // What gives nothing is where it says.
  DOUBLES_EQUAL(0, seen.motion_by({.mm_per_m_s2 = 0})->sigma_mm, 1e-12);
}

TEST(ArmSway, AScanThatShowsTheTableTellsWhatTheArmGives) {
  const Lap lap{.up_mm = [](double time_s) { return swing_mm(time_s, 0.02); }, .ahead_mm = 1};
  const ArmSway seen = lap.seen();
  const std::optional<ArmMotion> shown = seen.motion();
  CHECK(shown.has_value());
  CHECK(shown->source == ArmSource::Table);
  // Of another scan of that arm it then says the same.
  const std::optional<ArmMotion> sut = seen.motion_by({.mm_per_m_s2 = shown->give_mm_per_m_s2});
  DOUBLES_EQUAL(shown->sigma_mm, sut->sigma_mm, 1e-9);
}

TEST(ArmSway, WhereTheArmIsHurriedItGivesMore) {
  ArmSway seen;
  for (int i = 0; i < 300; ++i) {
    const double time_s = i / k_rate_hz;
    SE3 T_base_flange = SE3::Identity();
    if (time_s > 1 && time_s < 1.5) T_base_flange.translation().x() = std::sin(k_swing_rad_s * time_s);
    const std::vector points{Lap::foot(time_s).cast<float>().eval()};
    seen.add_profile(points, {.T_base_flange = T_base_flange, .time_s = time_s});
  }
  const std::optional<ArmMotion> sut = seen.motion_by(k_assumed_give);
  CHECK(sut.has_value());
  CHECK_COMPARE(sut->sigma_mm_at(Lap::foot(2.5)), <, 0.8 * sut->sigma_mm);
  CHECK_COMPARE(sut->sigma_mm_at(Lap::foot(1.25)), >, 1.5 * sut->sigma_mm);
}

TEST(ArmSway, AnAccelerationIsThatOfTheStripeNotOfTheFlange) {
  // The flange goes round the point that it looks at, at an even speed.
  std::vector<CarriedPoint> points;
  for (int i = 0; i < 20; ++i) {
    const double time_s = i / k_rate_hz;
    SE3 T_base_flange = SE3::Identity();
    T_base_flange.linear() = Eigen::AngleAxisd(2 * time_s, Vec3::UnitZ()).toRotationMatrix();
    T_base_flange.translation() = T_base_flange.linear() * Vec3{400, 0, 0};
    points.push_back({.T_base_flange = T_base_flange, .time_s = time_s, .point_base = Vec3::Zero()});
  }
  for (const double square : squared_accelerations(points)) DOUBLES_EQUAL(0, square, 1e-9);
  // 100 mm farther out: v^2 / r.
  for (CarriedPoint& point : points) point.point_base = point.T_base_flange * Vec3{100, 0, 0};
  for (const double square : squared_accelerations(points))
    DOUBLES_EQUAL(2 * 2 * 0.5, std::sqrt(square), 0.05);
}

TEST(ArmSway, AnAccelerationIsNotKnownOfFewProfilesOrOfTimeThatStands) {
  std::vector<CarriedPoint> points(4);
  for (std::size_t i = 0; i < points.size(); ++i) points[i].time_s = 0.01 * static_cast<double>(i);
  CHECK(squared_accelerations(points).empty());
  points.push_back(points.back());
  CHECK(squared_accelerations(points).empty());
  // Far apart: its neighbours in the row are enough.
  points.back().time_s = 2;
  CHECK_EQUAL(5, squared_accelerations(points).size());
  CHECK_FALSE(ArmSway{}.motion_by(k_assumed_give).has_value());
}

}  // namespace biteline::uncertainty
