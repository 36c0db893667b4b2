// SPDX-License-Identifier: MIT
#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include "host/bite_line/curve/curve_search.hpp"
#include "host/bite_line/curve/led_curve.hpp"
#include "tests/unit/host/bite_line/curve/blank_side.hpp"

namespace biteline::bite_line::test {

namespace {

/// Each state leads to the next one, and the last one to the first, a turn on.
bool closes(const ClosedCurve& curve) {
  for (std::size_t i = 0; i < curve.states.size(); ++i) {
    const CurveState& at = curve.states[i];
    CurveState next = curve.states[(i + 1) % curve.states.size()];
    if (i + 1 == curve.states.size()) next.col += k_cols;
    const CellStep step = k_cell_steps[at.direction];
    if (at.row + step.rows != next.row || at.col + step.cols != next.col) return false;
  }
  return true;
}

}  // namespace

TEST_GROUP(CurveSearch){};

TEST(CurveSearch, ALevelCreaseCostsItsLength) {
  constexpr float k_own = 0.05F;
  const CurveCosts costs = costs_where([](int row, int) { return row == 30; }, k_own);
  const std::optional<ClosedCurve> curve = CurveSearch{costs, {}}.best();
  CHECK(curve.has_value());
  CHECK(closes(*curve));
  LONGS_EQUAL(k_cols, curve->states.size());
  DOUBLES_EQUAL(k_turn_mm * k_own, curve->energy, 1e-3);
}

TEST(CurveSearch, FollowsAGuardThatRisesUpright) {
  const std::optional<ClosedCurve> curve = CurveSearch{costs_where(on_gate), {}}.best();
  CHECK(curve.has_value());
  CHECK(closes(*curve));
  CHECK(leads_over(*curve, 35, 81));
  CHECK(leads_over(*curve, 50, 95));
  CHECK(leads_over(*curve, 35, 109));
}

TEST(CurveSearch, GoesStraightOverAGapInItsCrease) {
  const std::optional<ClosedCurve> curve = CurveSearch{
      costs_where([](int row, int col) { return row == 30 && (col < 90 || col > 110); }),
      {}}.best();
  CHECK(curve.has_value());
  CHECK(leads_over(*curve, 30, 100));
}

TEST(CurveSearch, ASpiralIsNoClosedCurve) {
  // It rises by 20 rows once round: closed it must cross plain surface, 15 mm of it at 3 each.
  const auto spiral = [](int row, int col) { return std::abs(row - 20 - col / 10) <= 1; };
  const CurveCosts costs = costs_where(spiral);
  const std::optional<ClosedCurve> curve = CurveSearch{costs, {}}.best();
  CHECK(curve.has_value());
  CHECK(closes(*curve));
  CHECK(curve->energy > 30);
}

TEST(CurveSearch, ABendCostsTheSquareOfItsAngle) {
  // Up by ten cells at 45 degrees, and down again: each of the four bends is two, by a step that is between.
  const CurveCosts costs = costs_where([](int row, int col) {
    return row == 30 + std::clamp(col - 60, 0, 10) - std::clamp(col - 120, 0, 10);
  });
  const double soft = CurveSearch{costs, {.bend_mm = 0}}.best()->energy;
  const double level_mm = k_turn_mm + 20 * 0.75 * (std::sqrt(2.0) - 1);
  DOUBLES_EQUAL(level_mm * 0.05, soft, 0.05);
  const double level = 0.75, between = 0.75 * std::sqrt(5.0), steep = 0.75 * std::sqrt(2.0);
  const auto squared = [](double rad) { return rad * rad; };
  const double one_bend = squared(std::atan(0.5)) / (0.5 * (level + between)) +
                          squared(std::atan(1.0) - std::atan(0.5)) / (0.5 * (between + steep));
  const double stiff = CurveSearch{costs, {.bend_mm = 1}}.best()->energy;
  DOUBLES_EQUAL(soft + 4 * one_bend, stiff, 0.05);
}

TEST_GROUP(LedCurve){};

TEST(LedCurve, FollowsTheCheapestWayThroughItsLeadsInAnyDirection) {
  const CurveCosts costs = costs_where(on_gate);
  const Raster raster = blank_raster();
  const auto lead = [&](int row, int col, double reach_mm) {
    return CurveLead{.place = raster.place(row, col), .reach_mm = reach_mm};
  };
  // The hand is a cell beside the gate's top.
  const std::vector<CurveLead> leads{lead(20, 60, 0.5), lead(52, 95, 2.5), lead(20, 130, 0.5)};
  const auto sut = led_curve(raster, costs, leads, {});
  CHECK(sut.has_value());
  DOUBLES_EQUAL(0, (sut->front() - leads.front().place).norm(), 0.5);
  DOUBLES_EQUAL(0, (sut->back() - leads.back().place).norm(), 0.5);
  std::size_t beside = 0;
  for (const Vec2& at : *sut) {
    const int row = static_cast<int>(std::lround(raster.row_of(at.y())));
    const int col = static_cast<int>(std::lround(raster.col_of(at.x())));
    beside += on_gate(row, col) ? 0U : 1U;
  }
  CHECK_COMPARE(beside, <, sut->size() / 10);
}

TEST(LedCurve, GoesOnOverTheEndOfTheOutline) {
  const CurveCosts costs = costs_where([](int row, int) { return row == 30; });
  const Raster raster = blank_raster();
  const std::vector<CurveLead> leads{{.place = raster.place(30, k_cols - 20), .reach_mm = 0.5},
                                     {.place = raster.place(30, k_cols + 20), .reach_mm = 0.5}};
  const auto sut = led_curve(raster, costs, leads, {});
  CHECK(sut.has_value());
  LONGS_EQUAL(41, sut->size());
}

TEST(LedCurve, ToAPlaceBesideTheSideThereIsNone) {
  const CurveCosts costs = costs_where([](int row, int) { return row == 30; });
  const Raster raster = blank_raster();
  const std::vector<CurveLead> leads{{.place = raster.place(30, 20), .reach_mm = 0.5},
                                     {.place = raster.place(k_rows + 5, 60), .reach_mm = 0.5}};
  CHECK_FALSE(led_curve(raster, costs, leads, {}).has_value());
}

TEST(LedCurve, PointsOfAHandCountWhereTheyLieAndNotWhenTheyWereSet) {
  const auto lead = [](double s_mm, double z_mm) { return CurveLead{.place = {s_mm, z_mm}, .reach_mm = 1}; };
  // Up a flank, over the top, down the other one.
  const std::vector<CurveLead> leads{lead(0, 0),  lead(40, 20), lead(19, 8),
                                     lead(61, 9), lead(20, 18), lead(80, 0)};
  const std::vector<double> expected{0, 8, 18, 20, 9, 0};
  const std::vector<CurveLead> sut = in_order(leads);
  LONGS_EQUAL(expected.size(), sut.size());
  for (std::size_t i = 0; i < sut.size(); ++i) DOUBLES_EQUAL(expected[i], sut[i].place.y(), 0);
}

}  // namespace biteline::bite_line::test
