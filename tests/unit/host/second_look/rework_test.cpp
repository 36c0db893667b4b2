// SPDX-License-Identifier: MIT
#include "host/second_look/rework.hpp"

#include <CppUTest/TestHarness.h>

#include "tests/support/refusals.hpp"

namespace biteline::second_look {

TEST_GROUP(Rework) {
  PlannedBand plan{.low_mm = 2, .high_mm = 10};
  double line_mm = 600;
  ReworkWish wish;

  /// Profiles `step_mm` apart: the bad ones from the first to the last.
  Fault fault(double first_mm, double last_mm, double step_mm = 1) const {
    const auto on_line = [&](double mm) { return mm < 0 ? mm + line_mm : mm >= line_mm ? mm - line_mm : mm; };
    return {.kind = FaultKind::Missing,
            .along = {.from_mm = on_line(first_mm - step_mm / 2), .to_mm = on_line(last_mm + step_mm / 2)},
            .within = {.from_mm = on_line(first_mm - step_mm), .to_mm = on_line(last_mm + step_mm)},
            .low_mm = plan.low_mm,
            .high_mm = plan.high_mm};
  }
  Rework reworked(const std::vector<Fault>& faults) const {
    return rework_of(faults, plan, line_mm, wish);
  }
};

TEST(Rework, APieceGoesFromTheLastGoodProfileToTheNextOne) {
  const Rework rework = reworked({fault(100, 104, 0.5)});
  LONGS_EQUAL(1, rework.pieces.size());
  DOUBLES_EQUAL(99.5, rework.pieces[0].along.from_mm, 1e-9);
  DOUBLES_EQUAL(104.5, rework.pieces[0].along.to_mm, 1e-9);
  LONGS_EQUAL(0, rework.for_a_person.size());
}

TEST(Rework, WhereProfilesStandFarApartNoMoreThanAMillimetreIsWorkedTwice) {
  const Rework rework = reworked({fault(100, 104, 1.8)});
  // Work may begin right behind the last bad profile.
  CHECK(100 - rework.pieces[0].along.from_mm <= k_most_twice_mm);
  CHECK(rework.pieces[0].along.to_mm - 104 <= k_most_twice_mm);
  CHECK(100 - rework.pieces[0].along.from_mm > 0.9);
}

TEST(Rework, PiecesThatMeetAreOneAndOthersAreNot) {
  const Rework rework = reworked({fault(100, 104), fault(105.5, 108), fault(120, 124)});
  LONGS_EQUAL(2, rework.pieces.size());
  LONGS_EQUAL(2, rework.pieces[0].faults.size());
  DOUBLES_EQUAL(108.95, rework.pieces[0].along.to_mm, 1e-9);
  LONGS_EQUAL(2, rework.pieces[1].faults[0]);
}

TEST(Rework, OverTheLinesFirstPointAPieceIsOne) {
  const Rework rework = reworked({fault(0.4, 3), fault(595, 598.9)});
  LONGS_EQUAL(1, rework.pieces.size());
  DOUBLES_EQUAL(594.05, rework.pieces[0].along.from_mm, 1e-9);
  DOUBLES_EQUAL(3.95, rework.pieces[0].along.to_mm, 1e-9);
}

TEST(Rework, APieceWithinAnotherLengthensNothing) {
  Fault inner = fault(102, 103);
  inner.low_mm = 2.5;
  const Rework rework = reworked({fault(100, 110), inner});
  LONGS_EQUAL(1, rework.pieces.size());
  DOUBLES_EQUAL(110.95, rework.pieces[0].along.to_mm, 1e-9);
}

TEST(Rework, WhatIsThereAcrossIsNotWorkedTwiceUnlessAPersonSaysSo) {
  Fault narrow = fault(100, 110);
  narrow.kind = FaultKind::Narrow;
  narrow.low_mm = 8.5;
  LONGS_EQUAL(0, reworked({narrow}).pieces.size());
  LONGS_EQUAL(1, reworked({narrow}).for_a_person.size());
  wish.narrow = true;
  LONGS_EQUAL(1, reworked({narrow}).pieces.size());
}

TEST(Rework, WhatIsTooMuchNoWorkTakesAway) {
  wish.narrow = true;
  for (const FaultKind kind : {FaultKind::Wide, FaultKind::Beside, FaultKind::Doubled}) {
    Fault fault = this->fault(100, 110);
    fault.kind = kind;
    LONGS_EQUAL(0, reworked({fault}).pieces.size());
    LONGS_EQUAL(1, reworked({fault}).for_a_person.size());
  }
}

TEST(Rework, AllOfTheLineIsTheWorkItself) {
  Fault all{.kind = FaultKind::Missing,
            .along = {.from_mm = 0, .to_mm = line_mm},
            .within = {.from_mm = 0, .to_mm = line_mm},
            .low_mm = plan.low_mm,
            .high_mm = plan.high_mm};
  LONGS_EQUAL(0, reworked({all}).pieces.size());
  LONGS_EQUAL(1, reworked({all}).for_a_person.size());
}

TEST(Rework, EachReasonHasItsWords) {
  test::check_refusal_table(NoRework::ReworkedBefore);
  test::check_refusal_table(Settle::WorkRanOut);
}

}  // namespace biteline::second_look
