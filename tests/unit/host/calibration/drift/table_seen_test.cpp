// SPDX-License-Identifier: MIT
#include "host/calibration/drift/table_seen.hpp"

#include <CppUTest/TestHarness.h>

#include <numbers>
#include <random>

#include "host/calibration/drift/sums.hpp"
#include "tests/unit/host/calibration/drift/seen_ball.hpp"

namespace biteline::drift {
namespace {

struct TableDraw {
  Vector drifted{Vector::Zero()};  ///< of the head, and of the table
  double round_mm{120};            ///< radius of the way that the head goes
  double noise_mm{0.005};
};

/// What a head that goes round makes of a table, from its own side each time; by formula.
BallScan scan_table(const TableDraw& draw) {
  constexpr int k_frames = 180;
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  const geometry::SensorModel told = ball_head();
  const geometry::SensorModel actual =
      uncertainty::perturbed(told, axes_of(told), parameters_of(draw.drifted));
  const Vec3 middle{600, 40, 80};
  const Vec3 tilt{k_table[14].si * draw.drifted[14], k_table[15].si * draw.drifted[15], -1};
  const Vec3 table_normal = -tilt.normalized();
  const Vec3 table_at = middle + Vec3{0, 0, 0.1 * draw.drifted[k_table_at]};
  BallScan made;
  for (std::uint32_t k = 0; k < k_frames; ++k) {
    const double turn_rad = 2 * std::numbers::pi * k / k_frames;
    // Steeply down, somewhat outwards, and not always the same.
    const double lean_rad = 0.5 + 0.1 * std::sin(3 * turn_rad);
    SE3 T_base_cam = SE3::Identity();
    T_base_cam.linear() = (Eigen::AngleAxisd(turn_rad, Vec3::UnitZ()) *
                           Eigen::AngleAxisd(std::numbers::pi - lean_rad, Vec3::UnitY()))
                              .toRotationMatrix();
    T_base_cam.translation() = middle + draw.round_mm * Vec3{std::cos(turn_rad), std::sin(turn_rad), 0} -
                               T_base_cam.linear() * Vec3{0, 0, 200};
    const SE3 said = T_base_cam * told.T_flange_cam.inverse();
    made.poses.push_back({.profile = k, .pose = {.T_base_flange = said, .time_s = 0.01 * k}});
    const SE3 T_base_seen = said * actual.T_flange_cam;
    const Vec3 n = T_base_seen.linear().transpose() * table_normal;
    const Vec3 p = T_base_seen.inverse() * table_at;
    const Vec3& l = actual.laser_plane.normal_cam;
    const Vec3 along = l.cross(n).normalized();
    Mat3 meets;
    meets << l.transpose(), n.transpose(), along.transpose();
    const Vec3 foot = meets.inverse() * Vec3{actual.laser_plane.distance_mm, n.dot(p), along.dot(p)};
    for (int i = -10; i <= 10; ++i) {
      const Vec3 point = foot + 0.6 * i * along;
      const Vec3 seen = geometry::triangulate(told.camera, told.laser_plane, actual.camera.project(point));
      const Vec3 noisy = seen + draw.noise_mm * normal(random) * seen.normalized();
      made.points_base.push_back((said * told.T_flange_cam * noisy).cast<float>());
      made.profile.push_back(k);
    }
  }
  return made;
}

std::optional<TableEvidence> seen(const TableDraw& draw) {
  return see_table(scan_table(draw).view(), ball_head());
}

/// Each quantity alone, the table counted from the usual one.
double alone(const TableEvidence& now, const TablePlane& usual, int quantity) {
  const TableEvidence counted = now.counted_from(usual);
  return Sums{.information = counted.information, .pull = counted.pull}.alone()[quantity];
}

}  // namespace

TEST_GROUP(TableSeen){};

TEST(TableSeen, ATableAllRoundIsOnePlane) {
  const auto sut = seen({});
  CHECK(sut.has_value());
  CHECK_EQUAL(180, sut->profiles);
  DOUBLES_EQUAL(80, sut->plane.height_mm, 0.02);
  DOUBLES_EQUAL(0, sut->plane.slope_x, 1e-4);
  CHECK(sut->scatter_mm < 0.02);
}

TEST(TableSeen, ATableThatMovedIsMeasuredAgainstTheUsualOne) {
  const auto usual = seen({});
  CHECK(usual.has_value());
  for (int i = k_table_at; i < k_quantities; ++i) {
    const auto sut = seen({.drifted = 2 * Vector::Unit(i)});
    CHECK(sut.has_value());
    DOUBLES_EQUAL(2, alone(*sut, usual->plane, i), 0.1);
  }
}

TEST(TableSeen, AHeadThatDriftedSeesAnotherTableAndIsMeasured) {
  const auto usual = seen({});
  CHECK(usual.has_value());
  for (const int i : {5, 8}) {  // along the sight: laser offset, mounting z
    const auto sut = seen({.drifted = 2 * Vector::Unit(i)});
    CHECK(sut.has_value());
    DOUBLES_EQUAL(2, alone(*sut, usual->plane, i), 0.15);
  }
}

TEST(TableSeen, WhereItsOwnPlaneIsCountedFromDoesNotMatter) {
  const auto usual = seen({});
  const auto moved = seen({.drifted = Vector::Unit(k_table_at), .round_mm = 100});
  CHECK(usual && moved);
  // The same plane said of another middle.
  TablePlane same = usual->plane;
  same.middle += Vec2{100, -50};
  same.height_mm += 100 * same.slope_x - 50 * same.slope_y;
  for (const int i : {5, 8, k_table_at}) {
    const double from = alone(*moved, usual->plane, i);
    DOUBLES_EQUAL(from, alone(*moved, same, i), 1e-6);
  }
}

TEST(TableSeen, AFixtureOfAnotherHeightIsAnotherTable) {
  const auto usual = seen({}), higher = seen({.drifted = 40 * Vector::Unit(k_table_at)});
  CHECK(usual && higher);
  CHECK(higher->is_another(usual->plane));
  CHECK_FALSE(seen({.drifted = 2 * Vector::Unit(k_table_at)})->is_another(usual->plane));
}

TEST(TableSeen, WhatDoesNotGoRoundAShoeIsNoTable) {
  CHECK_FALSE(seen({.round_mm = 15}).has_value());
  CHECK_FALSE(see_table(scan_ball({}).view(), ball_head()).has_value());
  CHECK_FALSE(see_table({}, ball_head()).has_value());
}

}  // namespace biteline::drift
