// SPDX-License-Identifier: MIT
#include "tests/soak/light_book.hpp"

#include <CppUTest/TestHarness.h>

namespace biteline::soak {

TEST_GROUP(LightBook) {
  LightBook sut;
};

TEST(LightBook, EachLightingHasItsAsking) {
  LONGS_EQUAL(0, sut.unasked(0, 0));
  LONGS_EQUAL(0, sut.unasked(0, 1));
  LONGS_EQUAL(0, sut.unasked(1, 1));
  // Two looks in one: asked, lit, asked, lit.
  LONGS_EQUAL(0, sut.unasked(3, 3));
  // A service that leaves between asking and scan: a light, and no more words.
  LONGS_EQUAL(0, sut.unasked(3, 4));
  LONGS_EQUAL(0, sut.unasked(4, 4));
  LONGS_EQUAL(0, sut.unasked(4, 4));
}

TEST(LightBook, ALightThatNobodyAskedForIsFound) {
  LONGS_EQUAL(1, sut.unasked(1, 0));
  LONGS_EQUAL(0, sut.unasked(2, 1));
  LONGS_EQUAL(2, sut.unasked(4, 1));
}

/// Scans that stayed dark do not pay for a light.
TEST(LightBook, AnAskingWithoutLightIsOverWithTheNext) {
  LONGS_EQUAL(0, sut.unasked(0, 1));
  LONGS_EQUAL(0, sut.unasked(0, 2));
  LONGS_EQUAL(0, sut.unasked(0, 3));
  LONGS_EQUAL(0, sut.unasked(1, 3));
  LONGS_EQUAL(1, sut.unasked(2, 3));
}

}  // namespace biteline::soak
