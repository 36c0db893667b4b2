// SPDX-License-Identifier: MIT
#include "host/calibration/drift/table_seen.hpp"

#include <CppUTest/TestHarness.h>

#include "host/calibration/drift/sums.hpp"
#include "tests/unit/host/calibration/drift/seen_ball.hpp"
#include "tests/unit/host/calibration/drift/seen_table_round.hpp"

namespace biteline::drift {
namespace {

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
