// SPDX-License-Identifier: MIT
#include "host/geometry/logistic.hpp"

#include <CppUTest/TestHarness.h>

namespace biteline::geometry {

TEST_GROUP(Logistic){};

TEST(Logistic, LogOddsBecomeAProbability) {
  DOUBLES_EQUAL(0.5, logistic(0), 1e-15);
  DOUBLES_EQUAL(0.75, logistic(std::log(3.0)), 1e-15);
  DOUBLES_EQUAL(1, logistic(1.5) + logistic(-1.5), 1e-15);
}

TEST(Logistic, WhatIsCertainStaysAnOrdinaryNumber) {
  // exp() of these is too large, or too small: the test's flags would tell.
  DOUBLES_EQUAL(1, logistic(1e5), 0);
  CHECK(logistic(-1e5) > 0 && logistic(-1e5) < 1e-17);
}

}  // namespace biteline::geometry
