// SPDX-License-Identifier: MIT
#include <CppUTest/TestHarness.h>

#include <cmath>

#include "host/bite_line/place/confidence.hpp"
#include "host/bite_line/place/point_spread.hpp"
#include "host/cloud/closed_line.hpp"

namespace biteline::bite_line {

TEST_GROUP(Confidence){};

TEST(Confidence, AWiderBridgeHoldsLessWhateverWidensIt) {
  double by_corner = 1, by_trial = 1;
  for (int i = 1; i <= 60; ++i) {
    const double corner = bridge_held_of({.corner_mm = 1.0 * i});
    const double trial = bridge_held_of({.tried_mm = 0.1 * i});
    CHECK_COMPARE(corner, <, by_corner);
    CHECK_COMPARE(trial, <, by_trial);
    by_corner = corner;
    by_trial = trial;
  }
  CHECK_COMPARE(by_corner, <, 0.01);
  CHECK_COMPARE(by_trial, <, 0.01);
  CHECK_COMPARE(by_trial, >, 0);
}

TEST(Confidence, EachSpreadHoldsItsShare) {
  const ConfidenceModel model{.least_mm = 0.2,
                              .shares = {{{0.3, 0.99},
                                          {0.4, 0.95},
                                          {0.5, 0.9},
                                          {1.0, 0.6},
                                          {2.0, 0.2},
                                          {2.25, 0.18},
                                          {2.5, 0.15},
                                          {3.0, 0.1},
                                          {4.0, 0.04}}}};
  DOUBLES_EQUAL(0.99, bridge_held_of({}, model), 1e-12);
  DOUBLES_EQUAL(0.6, bridge_held_of({.tried_mm = 0.8}, model), 1e-12);
  DOUBLES_EQUAL(0.6, bridge_held_of({.corner_mm = 0.8 / model.corner_ratio}, model), 1e-12);
  // Another course and the trials add up; in between the logarithm counts.
  DOUBLES_EQUAL(0.6, bridge_held_of({.corner_mm = 0.5 / model.corner_ratio, .tried_mm = 0.3}, model), 1e-12);
  DOUBLES_EQUAL(0.4, bridge_held_of({.tried_mm = std::sqrt(2.0) - 0.2}, model), 1e-12);
  DOUBLES_EQUAL(0.01, bridge_held_of({.tried_mm = 7.8}, model), 1e-12);
}

TEST(Confidence, OneInTwoJumpsHoldsAtItsLimit) {
  const ConfidenceModel model;
  DOUBLES_EQUAL(0.5, jump_held_of(model.jump_mm, model), 1e-12);
  DOUBLES_EQUAL(0.5, jump_held_of(-model.jump_mm, model), 1e-12);
}

TEST(Confidence, WhatWasSeenAndDoesNotJumpHolds) {
  PlacedStation seen{.position = {0, 0, 30}, .own_z_mm = 30};
  DOUBLES_EQUAL(1, within_of(seen), 1e-12);
  seen.own_z_mm = 30.4;
  DOUBLES_EQUAL(jump_held_of(0.4), within_of(seen), 1e-12);
  seen.sharp = 0.5;
  DOUBLES_EQUAL(0.5 * jump_held_of(0.4), within_of(seen), 1e-12);
}

TEST(Confidence, AFlatSlopeCountsForLessSeenOrBridgedAndIsFlaggedAllTheSame) {
  PlacedStation flat{.position = {0, 0, 30}, .own_z_mm = 30};
  flat.sharp = 0.02;
  DOUBLES_EQUAL(ConfidenceModel{}.flat_held, within_of(flat), 1e-12);
  CHECK_COMPARE(within_of(flat), <, cloud::k_sure_ratio);
  flat.doubt = 0.5;
  flat.tried_up_mm = 0.8;
  DOUBLES_EQUAL(ConfidenceModel{}.flat_held * bridge_held_of({.tried_mm = 0.8}), within_of(flat), 1e-12);
}

TEST(Confidence, ABridgesHeightIsNoJump) {
  // The section of a place that was not seen is a bridge's own, and says nothing of the crease.
  PlacedStation bridged{.position = {0, 0, 30}, .own_z_mm = 31, .doubt = 0.5, .tried_out_mm = 0.3};
  bridged.tried_up_mm = 0.4;
  DOUBLES_EQUAL(bridge_held_of({.tried_mm = 0.5}), within_of(bridged), 1e-12);
}

TEST(Confidence, FewPointsWidenU95Outwards) {
  PlacedStation few{.position = {0, 0, 30}, .own_z_mm = 30, .few_out_mm = 0.15};
  const PointSpread spread = spread_of(few);
  DOUBLES_EQUAL(SpreadModel{}.few * few.few_out_mm, std::sqrt(spread.covariance_mm2(0, 0)), 1e-9);
  DOUBLES_EQUAL(0, spread.covariance_mm2(1, 1), 1e-12);
}

TEST(Confidence, ALongBridgeThatCouldNotBeTriedIsNoBetterForIt) {
  PlacedStation bridged{.position = {0, 0, 30}, .own_z_mm = 30, .doubt = 2};
  bridged.untried = true;
  DOUBLES_EQUAL(1.0 / 3, within_of(bridged), 1e-12);
}

TEST(Confidence, AWrittenLinesDoubtShrinksAndDoesNotVanish) {
  DOUBLES_EQUAL(1.0, line_held_of(1.0), 1e-12);
  DOUBLES_EQUAL(0.9, line_held_of(0.6, {.line_doubt_ratio = 0.25}), 1e-12);
  CHECK_COMPARE(line_held_of(0.98), <, 1.0);
}

}  // namespace biteline::bite_line
