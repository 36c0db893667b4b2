// SPDX-License-Identifier: MIT
#include "host/cloud/flagged.hpp"

#include <CppUTest/TestHarness.h>

namespace biteline::cloud {
namespace {

ClosedLine line_of(std::size_t sure, std::size_t unsure, std::size_t uncertain) {
  ClosedLine line;
  const auto add = [&](std::size_t count, double confidence, double u95_mm) {
    for (std::size_t i = 0; i < count; ++i) {
      line.points.push_back({.position = Vec3::Zero(),
                             .normal = Vec3::UnitX(),
                             .tangent = Vec3::UnitY(),
                             .confidence = confidence,
                             .u95_mm = u95_mm});
      flag_unsure(line.points.back());
    }
  };
  add(sure, 0.6, 0.9);
  add(unsure, 0.4, 1.1);
  add(uncertain, 0.6, 1.1);
  return line;
}

}  // namespace

TEST_GROUP(Flagged){};

TEST(Flagged, AnUnsurePointIsCountedOnceAndByItsConfidence) {
  const Flagged sut = flagged_of(line_of(14, 2, 4));
  DOUBLES_EQUAL(0.1, sut.unsure, 1e-12);
  DOUBLES_EQUAL(0.2, sut.uncertain, 1e-12);
  DOUBLES_EQUAL(0.3, sut.all(), 1e-12);
}

TEST(Flagged, ATenthMayBe) {
  CHECK_FALSE(flagged_of(line_of(91, 4, 5)).too_much());
  CHECK(flagged_of(line_of(89, 5, 6)).too_much());
}

TEST(Flagged, WhoAsksForMoreConfidenceCountsMore) {
  CHECK_FALSE(flagged_of(line_of(10, 0, 0)).too_much());
  CHECK(flagged_of(line_of(10, 0, 0), 0.7).too_much());
}

}  // namespace biteline::cloud
