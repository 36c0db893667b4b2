// SPDX-License-Identifier: MIT
#include <CppUTest/TestHarness.h>

#include "host/bite_line/place/confidence.hpp"

namespace biteline::bite_line {

TEST_GROUP(Confidence){};

TEST(Confidence, BothEndsStayAndMoreClaimedIsNeverLessHeld) {
  DOUBLES_EQUAL(0.0, held_of(0.0), 1e-12);
  DOUBLES_EQUAL(1.0, held_of(1.0), 1e-12);
  double before = 0;
  for (int i = 0; i <= 1000; ++i) {
    const double held = held_of(i / 1000.0);
    CHECK_COMPARE(held, >=, before);
    before = held;
  }
}

TEST(Confidence, BetweenTwoPlacesOfTheMapItIsStraight) {
  const ConfidenceModel model{.claimed = {0, 0.1, 0.2, 0.4, 0.5, 0.6, 0.8, 1},
                              .held = {0.1, 0.1, 0.3, 0.5, 0.6, 0.7, 0.9, 1}};
  DOUBLES_EQUAL(0.2, held_of(0.15, model), 1e-12);
  DOUBLES_EQUAL(0.5, held_of(0.4, model), 1e-12);
  DOUBLES_EQUAL(0.95, held_of(0.9, model), 1e-12);
}

TEST(Confidence, WhatLiesBesideTheMapIsAsItsEnds) {
  DOUBLES_EQUAL(held_of(0.0), held_of(-0.5), 1e-12);
  DOUBLES_EQUAL(1.0, held_of(1.5), 1e-12);
}

TEST(Confidence, AWrittenLinesDoubtShrinksAndDoesNotVanish) {
  DOUBLES_EQUAL(1.0, line_held_of(1.0), 1e-12);
  DOUBLES_EQUAL(0.9, line_held_of(0.6, {.line_doubt_ratio = 0.25}), 1e-12);
  CHECK_COMPARE(line_held_of(0.98), <, 1.0);
}

}  // namespace biteline::bite_line
