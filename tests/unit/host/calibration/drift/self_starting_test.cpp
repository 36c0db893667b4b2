// SPDX-License-Identifier: MIT
#include "host/calibration/drift/self_starting.hpp"

#include <CppUTest/TestHarness.h>

#include <random>

namespace biteline::drift {

TEST_GROUP(SelfStarting) {
  std::mt19937_64 random{7};
  std::normal_distribution<double> normal;
};

TEST(SelfStarting, AnUnchangedRowIsToldLessThanOnceIn40000Numbers) {
  // One of 13 rows of 1000 shoes then alarms less than once in three times: the bench counts more exactly.
  int told = 0;
  for (int row = 0; row < 80; ++row) {
    SelfStarting sut{0};
    for (int i = 0; i < 500; ++i) sut.take(3 + 0.2 * normal(random));
    told += sut.changed() ? 1 : 0;
  }
  LONGS_EQUAL(0, told);
}

TEST(SelfStarting, AJumpOfFiveDeviationsIsToldWithinFiveNumbersEitherWay) {
  for (const double jump : {5.0, -5.0}) {
    int late = 0;
    for (int row = 0; row < 100; ++row) {
      SelfStarting sut{0};
      for (int i = 0; i < 40; ++i) sut.take(normal(random));
      int after = 0;
      for (; after < 10 && !sut.changed(); ++after) sut.take(jump + normal(random));
      late += after > 5 ? 1 : 0;
    }
    CHECK(late <= 3);
  }
}

TEST(SelfStarting, OneWildNumberIsNoChange) {
  SelfStarting sut{0};
  for (int i = 0; i < 40; ++i) sut.take(normal(random));
  sut.take(1e6);
  CHECK_FALSE(sut.changed());
}

TEST(SelfStarting, NothingIsToldBeforeEnoughIsKnown) {
  SelfStarting sut{0};
  for (int i = 0; i < SelfStarting::k_least + SelfStarting::k_on_trial - 1; ++i) sut.take(i < 8 ? 0 : 100);
  CHECK_FALSE(sut.knows());
  CHECK_FALSE(sut.changed());
}

TEST(SelfStarting, ChangesBelowTheLeastSpreadAreNone) {
  SelfStarting sut{0.1};
  for (int i = 0; i < 40; ++i) sut.take(1e-4 * normal(random));
  for (int i = 0; i < 40; ++i) sut.take(0.05);
  CHECK_FALSE(sut.changed());
}

}  // namespace biteline::drift
