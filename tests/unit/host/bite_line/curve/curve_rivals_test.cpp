// SPDX-License-Identifier: MIT
#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "host/bite_line/curve/curve_costs.hpp"
#include "host/bite_line/curve/curve_on_side.hpp"
#include "host/bite_line/curve/curve_posterior.hpp"
#include "host/bite_line/curve/curve_rivals.hpp"
#include "tests/unit/host/bite_line/curve/blank_side.hpp"
#include "tests/unit/host/bite_line/drum.hpp"

namespace biteline::bite_line::test {

namespace {

std::vector<CurveRival> all_rivals(const CurveGround& ground, const ClosedCurve& curve,
                                   const RivalConfig& config) {
  return rivals_of(ground, {}, curve, way_above(ground, {}, curve, config), config);
}

}  // namespace

TEST_GROUP(CurveRivals){};

TEST(CurveRivals, AnotherCreaseAllRoundIsOneRival) {
  const CurveCosts costs = costs_where([](int row, int) { return row == 30 || row == 50; });
  const ClosedCurve best = best_of(costs);
  const std::vector<CurveRival> rivals = all_rivals(*ground_of(costs), best, {.per_mm = 0.2});
  LONGS_EQUAL(1, rivals.size());
  LONGS_EQUAL(best.states.size(), rivals.front().count);
  CHECK(leads_all_round(rivals.front(), best));
  DOUBLES_EQUAL(0, rivals.front().excess, 1e-3);
  const double away_mm = rivals.front().places[5].y() - blank_raster().place(best.states[5].row, 0).y();
  DOUBLES_EQUAL(15, std::abs(away_mm), 1e-6);
}

/// Where a side shows hardly anything else, as behind a high heel, two curves are one.
TEST(CurveRivals, AWayOverMostOfTheRoundIsAnotherCurve) {
  const auto is_another = [](int last) {
    constexpr int k_low = 30, k_up = 10;
    const CurveCosts costs = costs_where([&](int row, int col) {
      const int rise = std::clamp(std::min(col - 20, last - col), 0, +k_up);
      return row == k_low || row == k_low + rise;
    });
    const ClosedCurve best = best_of(costs);
    const std::vector<CurveRival> rivals = all_rivals(*ground_of(costs), best, {.above_per_mm = 0});
    // The stretch by itself is a rival, too.
    CHECK(std::ranges::any_of(rivals, [&](const auto& rival) { return rival.count < best.states.size(); }));
    return std::ranges::any_of(rivals, [&](const auto& rival) { return rival.count == best.states.size(); });
  };
  CHECK(is_another(150));
  CHECK(!is_another(100));
}

TEST(CurveRivals, AStretchBesideTheCurveTellsWhatItCostsMore) {
  // Over a hundred columns a second crease, ten cells above, that begins and ends with 45 degrees.
  constexpr int k_first = 100, k_last = 200, k_up = 10;
  const CurveCosts costs = costs_where([](int row, int col) {
    const int rise = std::min({k_up, col - k_first, k_last - col});
    return row == 30 || (rise > 0 && row == 30 + rise);
  });
  const ClosedCurve best = best_of(costs);
  const std::vector<CurveRival> rivals = all_rivals(*ground_of(costs), best, {.above_per_mm = 1});
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

TEST(CurveRivals, AStretchTellsWhereItIsFaintest) {
  // Between two leaps of 5 cells over plain surface the curve keeps to another crease, plainer than the line.
  constexpr int k_first = 80, k_last = 130, k_leap = 5;
  CurveCosts costs =
      costs_where([](int row, int col) { return row == 30 && (col < k_first || col > k_last); }, 0.3F);
  for (int col = 0; col < k_cols; ++col)
    for (std::size_t k = 0; k < k_directions; ++k) {
      if (col >= k_first && col <= k_last) costs.of(costs.at(30, col), k) = 1.5F;
      if (col >= k_first && col <= k_last) costs.of(costs.at(30 - k_leap, col), k) = 0.05F;
    }
  const auto ground = ground_of(costs);
  const ClosedCurve best = best_of(ground->costs);
  CHECK(leads_over(best, 30 - k_leap, 100));
  const std::vector<CurveRival> rivals = all_rivals(*ground, best, {.per_mm = 1});
  const auto straight = std::ranges::find_if(
      rivals, [](const CurveRival& rival) { return rival.length_mm > 30 && rival.length_mm < 60; });
  CHECK(straight != rivals.end());
  CHECK_COMPARE(straight->faintest_per_mm, >, 2);
}

TEST(CurveRivals, OneBehindAnotherIsFoundAsWell) {
  // Two more creases: one all round, and a dearer one over a part.
  const CurveCosts costs = costs_where([](int row, int col) {
    const bool on_part = row == 60 && col > 50 && col < 150;
    const bool on_flank = (col == 51 || col == 149) && row > 30 && row < 60;
    return row == 30 || row == 15 || on_part || on_flank;
  });
  const ClosedCurve best = best_of(costs);
  const std::vector<CurveRival> rivals = all_rivals(*ground_of(costs), best, {.per_mm = 0.6});
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
  CHECK(all_rivals(*ground_of(costs), best, {}).empty());
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

/// A groove in the sole's side is plainer than the line, which comes down to it at the heel.
TEST(CurveRivals, TheHigherOfTwoCurvesIsTakenThoughTheyMeet) {
  constexpr double k_groove_mm = 14, k_line_mm = 24;
  const auto line_mm = [](double s) {
    constexpr double k_heel_mm = 330, k_one_mm = 90, k_rise_mm = 50;  // of 618 mm once round
    const double off = std::clamp((std::abs(s - k_heel_mm) - k_one_mm) / k_rise_mm, 0.0, 1.0);
    return k_groove_mm + (k_line_mm - k_groove_mm) * 0.5 * (1 - std::cos(std::numbers::pi * off));
  };
  const Side side = drum_side([&](double s, double z) {
    constexpr double k_step_mm = 0.8, k_lean = 0.15, k_deep_mm = 2.5;
    const double up_mm = z - line_mm(s);
    return (up_mm < 0 ? 0.0 : -k_step_mm - k_lean * up_mm) -
           k_deep_mm * std::max(0.0, 1 - std::abs(z - k_groove_mm));
  });
  CurveGround ground = curve_ground(side);
  const auto found = best_curve(ground, {}, [](auto, auto) { return 0.0; });
  CHECK(found.has_value());
  for (const CurveState& at : found->curve.states) {
    const Vec2 place = ground.raster.place(at.row, ground.raster.round_col(at.col));
    const bool apart = line_mm(place.x()) > k_groove_mm + 5;
    if (apart) DOUBLES_EQUAL(line_mm(place.x()), place.y(), 2);
  }
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
  const std::vector<CurveStation> stations = curve_posterior(raster, best, {&rival, 1}, {}, 2.25, k_config);
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
      curve_posterior(raster, best, std::span{&rival, 1}, {}, RivalConfig{}.same_mm, k_config);
  DOUBLES_EQUAL(0.5, stations[half / 2].hold, 1e-6);
  DOUBLES_EQUAL(1, stations[half + half / 2].hold, 1e-6);
}

TEST(CurvePosterior, WaysThatLieTogetherCountOnce) {
  const CurveCosts costs = costs_where([](int row, int) { return row == 30 || row == 50; });
  const ClosedCurve best = best_of(costs);
  std::vector<CurveRival> rivals = all_rivals(*ground_of(costs), best, {});
  LONGS_EQUAL(1, rivals.size());
  rivals.front().seen = false;
  rivals.push_back(rivals.front());
  DOUBLES_EQUAL(0.5, curve_posterior(blank_raster(), best, rivals, {}, 2.25, {.unseen = 0})[10].hold, 0.01);
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

TEST(CurvePosterior, AStretchIsDoubtedForHowFaintItIsAsAWholeAndWhereItIsFaintest) {
  const ClosedCurve best = best_of(costs_where([](int row, int) { return row == 30; }));
  CurveRival rival{.count = 40, .length_mm = 30, .above_mm = 4, .seen = true};
  const auto log_odds = [&](double own_per_mm, double faintest_per_mm) {
    rival.own_per_mm = own_per_mm;
    rival.faintest_per_mm = faintest_per_mm;
    return log_odds_of(rival, best, {});
  };
  const double plain = log_odds(0.03, 0.1);
  CHECK_COMPARE(plain, <, -6);
  CHECK_COMPARE(log_odds(0.5, 0.7), >, plain + 2);
  CHECK_COMPARE(log_odds(0.03, 3.0), >, plain + 3);
  // What shows nothing is no better known for that.
  DOUBLES_EQUAL(log_odds(static_cast<double>(k_unseen_cost_per_mm), 3), log_odds(k_most_cost_per_mm, 3),
                1e-9);
  CHECK_COMPARE(log_odds(k_most_cost_per_mm, 3), >, -1);
}

TEST(CurvePosterior, OneFlankOfAGuardIsNoRivalOfTheOther) {
  const CurveCosts costs = costs_where(on_gate);
  const ClosedCurve curve = best_of(costs);
  const std::vector<CurveRival> rivals = all_rivals(*ground_of(costs), curve, {});
  for (const CurveStation& station : curve_posterior(blank_raster(), curve, rivals, {}, 2.25, {}))
    CHECK(station.hold > 0.9);
}

}  // namespace biteline::bite_line::test
