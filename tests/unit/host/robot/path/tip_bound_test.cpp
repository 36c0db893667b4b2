// SPDX-License-Identifier: MIT
#include "host/robot/path/tip_bound.hpp"

#include <CppUTest/TestHarness.h>

#include <cmath>

namespace biteline::path {

TEST_GROUP(TipBound) {
  TipParts parts{.line_u95_mm = 0.3, .give_mm = 0.2, .tip_u95_mm = 0.4};
};

TEST(TipBound, AddsTheGiveToWhatIsNotKnownOfLineAndTip) {
  DOUBLES_EQUAL(0.2 + 0.5, *tip_sum_mm(parts), 1e-12);
  DOUBLES_EQUAL(k_bound_factor * 0.7, *tip_bound_mm(parts), 1e-12);
  parts.tip_u95_mm = 0;
  DOUBLES_EQUAL(0.5, *tip_sum_mm(parts), 1e-12);
}

TEST(TipBound, IsNotKnownWhereTheLinesIsNot) {
  parts.line_u95_mm.reset();
  CHECK(!tip_sum_mm(parts));
  CHECK(!tip_bound_mm(parts));
  CHECK(!risk_beyond(parts, 1));
}

TEST(TipBound, RiskFallsWithTheToleranceAndIsAHalfAtTheMean) {
  DOUBLES_EQUAL(0.5, *risk_beyond(parts, k_mean_ratio * 0.7), 1e-9);
  CHECK(*risk_beyond(parts, 0.3) > *risk_beyond(parts, 0.6));
  // Within the bound nine shoes in ten are, and hardly one in a hundred beyond twice of it.
  CHECK(*risk_beyond(parts, *tip_bound_mm(parts)) < 0.1);
  CHECK(*risk_beyond(parts, 2 * *tip_bound_mm(parts)) < 0.01);
  DOUBLES_EQUAL(0, *risk_beyond({.line_u95_mm = 0}, 1), 0);
}

}  // namespace biteline::path
