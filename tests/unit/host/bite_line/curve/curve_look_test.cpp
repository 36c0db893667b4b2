// SPDX-License-Identifier: MIT
#include "host/bite_line/curve/curve_look.hpp"

#include <CppUTest/TestHarness.h>

#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include "host/bite_line/curve/curve_posterior.hpp"
#include "tests/unit/host/bite_line/curve/blank_side.hpp"

namespace biteline::bite_line::test {

namespace {

constexpr std::size_t k_places = 200;

SeenPlace place_of(double per_mm, float rim) {
  SeenPlace place{.signs = {}, .per_mm = per_mm, .mm = Raster::k_cell_mm};
  place.signs[static_cast<std::size_t>(CreaseSign::RimRight)] = rim;
  return place;
}

/// A plain line, but for 20 mm of an overlay's edge in the middle.
PlacesAlong with_an_edge(double per_mm, float rim) {
  PlacesAlong places(k_places, place_of(0.03, 0.1F));
  for (std::size_t i = 87; i < 113; ++i) places[i] = place_of(per_mm, rim);
  return places;
}

}  // namespace

TEST_GROUP(CurveLook){};

TEST(CurveLook, APlaceHasTheMeansOfTenMillimetresToBothSides) {
  const CurveLook look = look_of(with_an_edge(0.53, 0.6F));
  DOUBLES_EQUAL(0.03, look.places[10].per_mm, 1e-9);
  DOUBLES_EQUAL(0, look.places[10].unlike_rim, 1e-6);
  DOUBLES_EQUAL(0.53, look.places[100].per_mm, 0.05);
  DOUBLES_EQUAL(0.5, look.places[100].unlike_rim, 0.05);
  DOUBLES_EQUAL(0.28, look.places[87].per_mm, 0.03);
  DOUBLES_EQUAL(0.03 + 0.5 * 26 / k_places, look.per_mm, 1e-6);
}

TEST(CurveLook, AClosedCurveHasNoEnd) {
  PlacesAlong places(k_places, place_of(0.03, 0.1F));
  for (std::size_t i = 0; i < 20; ++i) places[i] = places[k_places - 1 - i] = place_of(1, 0.1F);
  const CurveLook look = look_of(places);
  DOUBLES_EQUAL(1, look.places[0].per_mm, 1e-9);
  DOUBLES_EQUAL(look.places[0].per_mm, look.places[k_places - 1].per_mm, 1e-9);
}

TEST(CurveLook, WhatWasNotSeenSaysNothing) {
  PlacesAlong places(k_places, place_of(0.03, 0.1F));
  for (std::size_t i = 80; i < 120; ++i) places[i].reset();
  const CurveLook look = look_of(places);
  CHECK(!look.places[100].seen);
  DOUBLES_EQUAL(0.03, look.places[81].per_mm, 1e-9);
  LONGS_EQUAL(160, seen_of(places, 0, k_places).size());
}

TEST(CurveLook, AStretchThatLooksUnlikeTheRestIsDoubtedWithoutARival) {
  const ClosedCurve curve = best_of(costs_where([](int row, int) { return row == 30; }));
  const auto odds_against = [&](double per_mm, float rim) {
    const CurveLook look = look_of(with_an_edge(per_mm, rim));
    const double hold = curve_posterior(blank_raster(), curve, {}, look, 2.25, {})[100].hold;
    return 1 / hold - 1;
  };
  CHECK_COMPARE(odds_against(0.03, 0.1F), <, 0.01);
  CHECK_COMPARE(odds_against(0.8, 0.1F), >, 5 * odds_against(0.03, 0.1F));
  CHECK_COMPARE(odds_against(0.8, 0.9F), >, 0.1);
}

TEST(CurveLook, AWayAboveMostOfTheCurveIsASign) {
  const ClosedCurve curve = best_of(costs_where([](int row, int) { return row == 30; }));
  const CurveLook look = look_of(with_an_edge(0.03, 0.1F));
  CurveRival rival{.count = k_places / 2, .length_mm = k_turn_mm / 2, .above_mm = 8, .seen = true};
  rival.two_surfaces = 0.8;
  const auto signs = place_signs(curve, {&rival, 1}, look);
  DOUBLES_EQUAL(0.4, signs[10]->back(), 1e-2);
  DOUBLES_EQUAL(0, signs[k_places - 10]->back(), 1e-9);
  rival.above_mm = -8;
  DOUBLES_EQUAL(0, place_signs(curve, {&rival, 1}, look)[10]->back(), 1e-9);
}

}  // namespace biteline::bite_line::test
