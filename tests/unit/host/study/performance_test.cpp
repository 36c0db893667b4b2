// SPDX-License-Identifier: MIT
#include "host/study/performance.hpp"

#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "tests/support/errors.hpp"

namespace biteline::study {

TEST_GROUP(Performance){};

/// NIST/SEMATECH e-Handbook, 6.1.6: limits 8 and 20, mean 16, standard deviation 2: 1.0 and 0.6667.
TEST(Performance, TheHandbooksExampleIsMet) {
  // 16 -+ a, 40 of each: s = a sqrt(80 / 79).
  const double a = 2 * std::sqrt(79.0 / 80);
  std::vector<double> values(40, 16 - a);
  values.insert(values.end(), 40, 16 + a);
  const Performance sut = *performance(values, {.low = 8, .high = 20});
  LONGS_EQUAL(80, sut.count);
  DOUBLES_EQUAL(16, sut.mean, 1e-12);
  DOUBLES_EQUAL(2, sut.deviation, 1e-12);
  DOUBLES_EQUAL(1, sut.pp, 1e-12);
  DOUBLES_EQUAL(2.0 / 3, sut.ppk, 1e-12);
  // 0.6667 - 1.645 sqrt(1 / 720 + 0.4444 / 158).
  DOUBLES_EQUAL(0.56004, sut.ppk_low, 5e-5);
  LONGS_EQUAL(0, sut.outside);
}

TEST(Performance, TheNearerLimitCounts) {
  const std::vector<double> values{9, 10, 11};
  DOUBLES_EQUAL(1.0 / 3, performance(values, {.low = 9, .high = 20})->ppk, 1e-12);
  DOUBLES_EQUAL(2.0 / 3, performance(values, {.low = 0, .high = 12})->ppk, 1e-12);
  const Performance beyond = *performance(values, {.low = 10.5, .high = 20});
  CHECK(beyond.ppk < 0);
  LONGS_EQUAL(2, beyond.outside);
}

TEST(Performance, TheTrueIndexIsNotBelowTheBoundInNineteenOfTwenty) {
  std::mt19937 random{7};
  std::normal_distribution<double> part{0.2, 0.2};  // limits -+1: Ppk = 0.8 / 0.6
  constexpr int k_rounds = 4000;
  int held = 0;
  for (int i = 0; i < k_rounds; ++i) {
    std::vector<double> values(30);
    for (double& value : values) value = part(random);
    if (performance(values, {.low = -1, .high = 1})->ppk_low <= 0.8 / 0.6) ++held;
  }
  // The bound is an approximation: it holds in 94.7 % of 200 000 such rounds.  Beside that a binomial's
  // spread.
  DOUBLES_EQUAL(0.95, static_cast<double>(held) / k_rounds, 0.003 + 3 * std::sqrt(0.05 * 0.95 / k_rounds));
}

TEST(Performance, WhatHasNoSpreadHasNoIndex) {
  FAILS_NAMING(Errc::BadValue, "no spread", performance(std::vector<double>{1, 1, 1}, {.low = 0, .high = 2}));
  FAILS_NAMING(Errc::BadValue, "at least 2", performance(std::vector<double>{1}, {.low = 0, .high = 2}));
  FAILS_NAMING(Errc::BadValue, "lower one first",
               performance(std::vector<double>{1, 2}, {.low = 2, .high = 2}));
}

}  // namespace biteline::study
