// SPDX-License-Identifier: MIT
#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <numbers>
#include <optional>
#include <span>
#include <vector>

#include "host/bite_line/curve/curve_costs.hpp"
#include "host/bite_line/curve/curve_ground.hpp"
#include "host/bite_line/curve/curve_on_side.hpp"
#include "host/bite_line/curve/curve_posterior.hpp"
#include "host/bite_line/curve/curve_rivals.hpp"
#include "host/bite_line/curve/curve_search.hpp"
#include "host/bite_line/curve/led_curve.hpp"
#include "host/bite_line/find_bite_line.hpp"
#include "tests/unit/host/bite_line/drum.hpp"

namespace biteline::bite_line::test {

namespace {

constexpr double k_turn_mm = 150;
constexpr int k_rows = 80, k_cols = 200;

/// Cells of which those that `on` says cost `own` for each millimetre in any direction, the others 3.
CurveCosts costs_where(const std::function<bool(int row, int col)>& on, float own = 0.05F) {
  CurveCosts costs{.rows = k_rows, .cols = k_cols, .per_mm = {}};
  costs.per_mm.resize(static_cast<std::size_t>(k_rows) * k_cols * k_directions);
  for (int col = 0; col < k_cols; ++col)
    for (int row = 0; row < k_rows; ++row)
      for (std::size_t k = 0; k < k_directions; ++k)
        costs.of(costs.at(row, col), k) = on(row, col) ? own : 3.0F;
  return costs;
}

Raster blank_raster() {
  Raster raster;
  raster.rows = k_rows;
  raster.cols = k_cols;
  raster.col_mm = k_turn_mm / k_cols;
  for (Large<float>* values : {&raster.o_mm, &raster.along_ratio, &raster.up_ratio}) {
    values->resize(raster.size());
    std::fill(values->begin(), values->end(), 0.0F);
  }
  raster.seen.resize(raster.size());
  std::fill(raster.seen.begin(), raster.seen.end(), std::uint8_t{1});
  return raster;
}

/// A guard: straight up, along, and straight down again.
bool on_gate(int row, int col) {
  constexpr int k_low = 20, k_high = 50, k_from = 80, k_to = 110;
  const auto near = [](int a, int b) { return std::abs(a - b) <= 1; };
  if (col < k_from || col > k_to) return near(row, k_low);
  const bool flank = near(col, k_from + 1) || near(col, k_to - 1);
  return near(row, k_high) || (flank && row >= k_low && row <= k_high);
}

/// A blank side with these costs.
std::unique_ptr<CurveGround> ground_of(CurveCosts costs) {
  auto ground = std::make_unique<CurveGround>(blank_raster(), fitted_weights());
  ground->costs = std::move(costs);
  return ground;
}

ClosedCurve best_of(const CurveCosts& costs) {
  std::optional<ClosedCurve> best = CurveSearch{costs, {}}.best();
  CHECK(best.has_value());
  return *std::move(best);
}

bool leads_over(const ClosedCurve& curve, int row, int col) {
  return std::ranges::any_of(curve.states, [&](const CurveState& at) {
    return std::abs(at.row - row) <= 1 && std::abs((at.col - col) % k_cols) <= 1;
  });
}

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

Raster raster_of(const Side& side) {
  const SideGrid& grid = side.field.grid;
  return Raster::of({side.field.places.data(), side.field.places.size()}, side.outline.length_mm(),
                    grid.z_low_mm, grid.rows * grid.row_mm, side.field.points_per_mm2);
}

/// Sole below `z_mm`, upper above it: the sole stands out by a millimetre.
double stepped_mm(double z, double at_mm) {
  constexpr double k_step_mm = 1.0, k_lean = 0.1;
  return z < at_mm ? 0.0 : -k_step_mm - k_lean * (z - at_mm);
}

/// A sole that is nearly flush: it ends at `at_mm`, and the upper leans outwards for 12 mm.
double faint_mm(double z, double at_mm) {
  constexpr double k_step_mm = 0.35, k_lean = 0.2, k_up_mm = 12;
  const double up_mm = z - at_mm;
  return up_mm < 0 ? 0.0
                   : -k_step_mm + k_lean * std::min(up_mm, k_up_mm) - k_lean * std::max(0.0, up_mm - k_up_mm);
}

bool everywhere(double) {
  return true;
}

/// The share of a drum's best curve that lies within 1.5 mm of a height, where `at` holds.
double share_at(const std::function<double(double s, double z)>& surface, double z_mm,
                const std::function<bool(double s)>& at) {
  const Side side = drum_side(surface);
  CurveGround ground = curve_ground(side);
  const auto found = best_curve(ground, {}, [](auto, auto) { return 0.0; });
  CHECK(found.has_value());
  double near = 0, all = 0;
  for (const CurveState& state : found->curve.states) {
    const Vec2 place = ground.raster.place(state.row, ground.raster.round_col(state.col));
    if (!at(place.x())) continue;
    all += 1;
    near += std::abs(place.y() - z_mm) < 1.5 ? 1 : 0;
  }
  return near / all;
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

TEST_GROUP(CurveRivals){};

TEST(CurveRivals, AnotherCreaseAllRoundIsOneRival) {
  const CurveCosts costs = costs_where([](int row, int) { return row == 30 || row == 50; });
  const ClosedCurve best = best_of(costs);
  const std::vector<CurveRival> rivals = rivals_of(*ground_of(costs), {}, best, {.per_mm = 0.2});
  LONGS_EQUAL(1, rivals.size());
  LONGS_EQUAL(best.states.size(), rivals.front().count);
  CHECK(leads_all_round(rivals.front(), best));
  DOUBLES_EQUAL(0, rivals.front().excess, 1e-3);
  const double away_mm = rivals.front().places[5].y() - blank_raster().place(best.states[5].row, 0).y();
  DOUBLES_EQUAL(15, std::abs(away_mm), 1e-6);
}

TEST(CurveRivals, AStretchBesideTheCurveTellsWhatItCostsMore) {
  // Over a hundred columns a second crease, ten cells above, that begins and ends with 45 degrees.
  constexpr int k_first = 100, k_last = 200, k_up = 10;
  const CurveCosts costs = costs_where([](int row, int col) {
    const int rise = std::min({k_up, col - k_first, k_last - col});
    return row == 30 || (rise > 0 && row == 30 + rise);
  });
  const ClosedCurve best = best_of(costs);
  const std::vector<CurveRival> rivals = rivals_of(*ground_of(costs), {}, best, {.above_per_mm = 1});
  LONGS_EQUAL(1, rivals.size());
  const CurveRival& rival = rivals.front();
  CHECK(!leads_all_round(rival, best));
  // Off by more than the band of 3 cells; the slants cost their length, the corners their bends.
  DOUBLES_EQUAL(0.75 * (k_last - k_first - 8), rival.length_mm, 4);
  CHECK(rival.excess > 0.5);
  CHECK(rival.excess < 6);
  double most_mm = 0;
  for (const Vec2& place : rival.places) most_mm = std::max(most_mm, place.y());
  DOUBLES_EQUAL(blank_raster().place(30 + k_up, 0).y(), most_mm, 1e-6);
}

TEST(CurveRivals, OneBehindAnotherIsFoundAsWell) {
  // Two more creases: one all round, and a dearer one over a part.
  const CurveCosts costs = costs_where([](int row, int col) {
    const bool on_part = row == 60 && col > 50 && col < 150;
    const bool on_flank = (col == 51 || col == 149) && row > 30 && row < 60;
    return row == 30 || row == 15 || on_part || on_flank;
  });
  const ClosedCurve best = best_of(costs);
  const std::vector<CurveRival> rivals = rivals_of(*ground_of(costs), {}, best, {.per_mm = 0.6});
  const auto leads_to = [&](const CurveRival& rival, int row) {
    return std::ranges::any_of(rival.places, [&](const Vec2& at) {
      return std::abs(at.y() - blank_raster().place(row, 0).y()) < 1e-6;
    });
  };
  CHECK(std::ranges::any_of(rivals, [&](const CurveRival& rival) { return leads_to(rival, 60); }));
  CHECK(std::ranges::any_of(rivals, [&](const CurveRival& rival) {
    return leads_to(rival, best.states.front().row == 30 ? 15 : 30);
  }));
}

TEST(CurveRivals, ACurveByItselfHasNone) {
  const CurveCosts costs = costs_where([](int row, int) { return row == 30; });
  const ClosedCurve best = best_of(costs);
  CHECK(rivals_of(*ground_of(costs), {}, best, {}).empty());
}

TEST(CurveRivals, AFaintWayAllRoundAboveIsOneHoweverPlainTheCurveIs) {
  const auto above_at = [](float per_mm) {
    CurveCosts costs = costs_where([](int row, int) { return row == 30; });
    for (int col = 0; col < k_cols; ++col)
      for (std::size_t k = 0; k < k_directions; ++k) costs.of(costs.at(50, col), k) = per_mm;
    const ClosedCurve best = best_of(costs);
    return way_above(*ground_of(costs), {}, best, {.above_per_mm = 2.0});
  };
  const std::optional<CurveRival> above = above_at(1.5F);
  CHECK(above.has_value());
  DOUBLES_EQUAL(15, above->above_mm, 1e-6);
  DOUBLES_EQUAL(k_turn_mm * (1.5 - 0.05), above->excess, 0.1);
  CHECK(!above_at(2.5F).has_value());
}

/// What a deep groove in a sole's side usually shows makes the faint line above it too dear to be a rival.
TEST(CurveRivals, AWayAllRoundAboveIsNotForgottenForLookingOtherwiseThanTheCurve) {
  constexpr double k_groove_mm = 14, k_deep_mm = 4, k_line_mm = 22;
  const Side side = drum_side([](double, double z) {
    constexpr double k_step_mm = 0.2, k_lean = 0.09, k_up_mm = 12;
    const double up_mm = z - k_line_mm;
    const double upper_mm = k_lean * (std::min(up_mm, k_up_mm) - std::max(0.0, up_mm - k_up_mm)) - k_step_mm;
    return (up_mm < 0 ? 0.0 : upper_mm) - k_deep_mm * std::max(0.0, 1 - std::abs(z - k_groove_mm));
  });
  CurveGround ground = curve_ground(side);
  const ClosedCurve groove = best_of(ground.costs);
  DOUBLES_EQUAL(k_groove_mm, ground.raster.place(groove.states[5].row, 0).y(), 1.5);
  CHECK(way_above(ground, {}, groove, {}).has_value());
  const auto found = best_curve(ground, {}, [](auto, auto) { return -10.0; });
  CHECK(found.has_value());
  CHECK_FALSE(way_above(ground, {}, found->curve, {}).has_value());
  CHECK(std::ranges::any_of(found->rivals, [&](const CurveRival& rival) {
    return leads_all_round(rival, found->curve) && std::abs(rival.above_mm - (k_line_mm - k_groove_mm)) < 2;
  }));
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

TEST_GROUP(CurvePosterior){};

TEST(CurvePosterior, AnotherWayAsLikelyTakesHalfOfItsStretchAlone) {
  const ClosedCurve best = best_of(costs_where([](int row, int) { return row == 30; }));
  const Raster raster = blank_raster();
  constexpr PosteriorConfig k_config{};
  CurveRival rival{.first = 20, .count = 40, .length_mm = 30};
  rival.excess = 1;
  rival.excess = -k_config.unseen / k_config.unseen_more / more_per_mm(rival);
  for (std::size_t i = rival.first; i < rival.first + rival.count; ++i)
    rival.places.push_back(raster.place(best.states[i].row + 20, best.states[i].col));
  const std::vector<CurveStation> stations = curve_posterior(raster, best, {&rival, 1}, 2.25, k_config);
  DOUBLES_EQUAL(0.5, stations[40].hold, 1e-6);
  LONGS_EQUAL(1, stations[40].alternatives.size());
  DOUBLES_EQUAL(15, stations[40].alternatives.front().off_mm, 1e-3);
  DOUBLES_EQUAL(0.5, stations[40].alternatives.front().mass, 1e-6);
  DOUBLES_EQUAL(1, stations[80].hold, 1e-6);
}

TEST(CurvePosterior, AWayAllRoundTakesNothingWhereItRunsOnTheCurve) {
  const ClosedCurve best = best_of(costs_where([](int row, int) { return row == 30; }));
  const Raster raster = blank_raster();
  constexpr PosteriorConfig k_config{};
  CurveRival rival{.count = best.states.size(), .above_mm = 5, .seen = true, .as_whole = -k_config.round[0]};
  const std::size_t half = best.states.size() / 2;
  for (std::size_t i = 0; i < best.states.size(); ++i)
    rival.places.push_back(raster.place(best.states[i].row + (i < half ? 20 : 0), best.states[i].col));
  const std::vector<CurveStation> stations =
      curve_posterior(raster, best, std::span{&rival, 1}, RivalConfig{}.same_mm, k_config);
  DOUBLES_EQUAL(0.5, stations[half / 2].hold, 1e-6);
  DOUBLES_EQUAL(1, stations[half + half / 2].hold, 1e-6);
}

TEST(CurvePosterior, WaysThatLieTogetherCountOnce) {
  const CurveCosts costs = costs_where([](int row, int) { return row == 30 || row == 50; });
  const ClosedCurve best = best_of(costs);
  std::vector<CurveRival> rivals = rivals_of(*ground_of(costs), {}, best, {});
  LONGS_EQUAL(1, rivals.size());
  rivals.front().seen = false;
  rivals.push_back(rivals.front());
  DOUBLES_EQUAL(0.5, curve_posterior(blank_raster(), best, rivals, 2.25, {.unseen = 0})[10].hold, 0.01);
}

TEST(CurvePosterior, OfTwoAllRoundTheUpperOneIsTheLineWhereItLiesBetweenTwoSurfaces) {
  const ClosedCurve best = best_of(costs_where([](int row, int) { return row == 30; }));
  CurveRival rival{.count = best.states.size(), .length_mm = k_turn_mm, .excess = k_turn_mm, .seen = true};
  const auto log_odds = [&](double above_mm, double two_surfaces, double uneven) {
    rival.above_mm = above_mm;
    rival.two_surfaces = two_surfaces;
    rival.uneven = uneven;
    return log_odds_of(rival, best, {});
  };
  CHECK_COMPARE(log_odds(8, 0.98, 0.1), >, 3);
  CHECK_COMPARE(log_odds(8, 0.4, 0.1), <, -1);  // a seam
  CHECK_COMPARE(log_odds(8, 0.9, 1.5), <, -1);  // pieces of overlays
  CHECK_COMPARE(log_odds(-8, 0.98, 0.1), <, -3);
}

TEST(CurvePosterior, AStretchIsDoubtedThatIsFainterAndLessEvenThanAPlainLine) {
  const ClosedCurve best = best_of(costs_where([](int row, int) { return row == 30; }));
  CurveRival rival{
      .count = 40, .length_mm = 30, .above_mm = 4, .seen = true, .own_per_mm = 0.5, .rest_per_mm = 0.5};
  const double faint = log_odds_of(rival, best, {});
  rival.own_uneven = 0.8;
  CHECK_COMPARE(log_odds_of(rival, best, {}), >, faint + 1);
  rival.own_uneven = 0;
  rival.own_per_mm = 0.03;
  CHECK_COMPARE(log_odds_of(rival, best, {}), <, faint - 2);
  CHECK_COMPARE(log_odds_of(rival, best, {}), <, -4);
}

TEST(CurvePosterior, OneFlankOfAGuardIsNoRivalOfTheOther) {
  const CurveCosts costs = costs_where(on_gate);
  const ClosedCurve curve = best_of(costs);
  const std::vector<CurveRival> rivals = rivals_of(*ground_of(costs), {}, curve, {});
  for (const CurveStation& station : curve_posterior(blank_raster(), curve, rivals, 2.25, {}))
    CHECK(station.hold > 0.9);
}

TEST_GROUP(CurveCosts){void teardown() override{forgive_underflow();
}  // namespace biteline::bite_line::test
}
;

TEST(CurveCosts, AStepAllRoundIsCheapInItsDirectionAlone) {
  const Side side = drum_side([](double, double z) { return stepped_mm(z, 25); });
  const Raster raster = raster_of(side);
  CreaseLooks looks{raster};
  const CurveCosts costs = curve_costs(raster, looks, fitted_weights());
  const int row = static_cast<int>(std::lround(raster.row_of(25)));
  const auto least = [&](std::size_t direction, int at) {
    float cost = k_most_cost_per_mm;
    for (int r = at - 1; r <= at + 1; ++r) cost = std::min(cost, costs.of(costs.at(r, 100), direction));
    return cost;
  };
  CHECK(least(k_level_direction, row) < 0.5F);
  CHECK(least(k_level_direction + 4, row) > 1.0F);
  CHECK(least(k_level_direction, row + 15) > 1.0F);
}

TEST(CurveCosts, ACurveFollowsAStepThatRisesUprightRoundTheToe) {
  const auto height_mm = [](double s) { return s > 300 && s < 340 ? 40.0 : 25.0; };
  const Side side = drum_side([&](double s, double z) { return stepped_mm(z, height_mm(s)); });
  const Raster raster = raster_of(side);
  CreaseLooks looks{raster};
  const CurveCosts costs = curve_costs(raster, looks, fitted_weights());
  const std::optional<ClosedCurve> curve = CurveSearch{costs, {}}.best();
  CHECK(curve.has_value());
  for (const CurveState& at : curve->states) {
    const Vec2 place = raster.place(at.row, raster.round_col(at.col));
    const bool beside_flank = std::abs(place.x() - 300) < 3 || std::abs(place.x() - 340) < 3;
    if (!beside_flank) DOUBLES_EQUAL(height_mm(place.x()), place.y(), 1.2);
  }
}

TEST_GROUP(BestCurve){};

TEST(BestCurve, AFaintStepAllRoundIsTheLineAndAPlainLedgeBelowItIsNot) {
  const auto surface = [](double, double z) { return (z < 25 ? 1.5 : 0.0) + faint_mm(z, 33); };
  CHECK_COMPARE(share_at(surface, 33, everywhere), >, 0.98);
}

TEST(BestCurve, AGrooveAllRoundAboveTheStepIsASeam) {
  const auto surface = [](double, double z) {
    return stepped_mm(z, 25) - 0.25 * std::max(0.0, 1 - std::abs(z - 35) / 0.8);
  };
  CHECK_COMPARE(share_at(surface, 25, everywhere), >, 0.98);
}

TEST(BestCurve, APlainEdgeBelowAFaintLineIsNotTakenOverAPart) {
  const auto by_bumper = [](double s) { return s > 290 && s < 370; };
  const auto surface = [&](double s, double z) {
    return (by_bumper(s) && z > 12 && z < 27 ? 1.2 : 0.0) + faint_mm(z, 33);
  };
  CHECK_COMPARE(share_at(surface, 33, by_bumper), >, 0.9);
}

TEST_GROUP(FindByCurve){void teardown() override{forgive_underflow();
}  // namespace biteline::bite_line::test
}
;

TEST(FindByCurve, AnotherWayOfAStretchIsACandidate) {
  // A faint step; over 60 mm it is two, 4 mm above and below, of which the lower one takes six tenths.
  constexpr double k_from_mm = 290, k_to_mm = 350, k_half_mm = 4, k_step_mm = 0.35, k_lower_share = 0.6;
  cloud::PointCloud cloud;
  cloud.points = drum_points(egg_outline(), [](double s, double z) {
    const double beyond_mm = std::max({0.0, k_from_mm - s, s - k_to_mm});
    const double by_mm = std::max(0.0, k_half_mm - beyond_mm);
    return -0.1 * std::max(0.0, z - 25) - (z > 25 - by_mm ? k_lower_share * k_step_mm : 0) -
           (z > 25 + by_mm ? (1 - k_lower_share) * k_step_mm : 0);
  });
  const Extraction found = find_bite_line(cloud, {});
  CHECK(found.candidates.size() > 1);
  const std::vector<Vec3>&one = found.candidates[0].points, &other = found.candidates[1].points;
  LONGS_EQUAL(one.size(), other.size());
  double most_mm = 0;
  for (std::size_t i = 0; i < one.size(); ++i)
    most_mm = std::max(most_mm, std::abs(one[i].z() - other[i].z()));
  DOUBLES_EQUAL(2 * k_half_mm, most_mm, 1.0);
}

TEST_GROUP(CurveRaster){};

TEST(CurveRaster, APlaneIsReadAsItself) {
  std::vector<OutlinePlace> places;
  constexpr double k_along = 0.2, k_up = -0.5;
  for (double s = 0.1; s < k_turn_mm; s += 0.4)
    for (double z = 10.1; z < 40; z += 0.4)
      places.push_back(
          {static_cast<float>(s), static_cast<float>(k_along * s + k_up * z), static_cast<float>(z)});
  const Raster raster = Raster::of(places, k_turn_mm, 10, 30, 6);
  const int row = raster.rows / 2, col = raster.cols / 2;
  const std::size_t cell = raster.at(row, col);
  const Vec2 place = raster.place(row, col);
  CHECK(raster.seen[cell] != 0);
  DOUBLES_EQUAL(k_along * place.x() + k_up * place.y(), static_cast<double>(raster.o_mm[cell]), 0.02);
  DOUBLES_EQUAL(k_up, static_cast<double>(raster.up_ratio[cell]), 0.06);
  DOUBLES_EQUAL(k_along, static_cast<double>(raster.along_ratio[cell]), 0.04);
}

TEST(CurveRaster, BetweenProfilesTwoMillimetresApartTheSurfaceIsSeen) {
  std::vector<OutlinePlace> places;
  for (double s = 0.3; s < k_turn_mm; s += 2)
    for (double z = 10.1; z < 40; z += 0.15)
      places.push_back({static_cast<float>(s), 0, static_cast<float>(z)});
  const Raster raster = Raster::of(places, k_turn_mm, 10, 30, 3.3);
  LONGS_EQUAL(raster.size(), std::ranges::count(raster.seen, 1));
}

}  // namespace biteline::bite_line::test
