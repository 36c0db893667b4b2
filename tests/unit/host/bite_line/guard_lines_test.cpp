// SPDX-License-Identifier: MIT
// Shoes with a guard on the toe whose lines were wrong once, by the seed and index of bench_line_sweep
// --guard.
#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <initializer_list>
#include <utility>

#include "host/bite_line/find_bite_line.hpp"
#include "tests/support/line_sweep.hpp"
#include "tests/support/uncertain_scan.hpp"

namespace biteline::test {

namespace {

SweepScan scan_with_guard(std::uint64_t seed, std::uint64_t index) {
  SweepCell cell = sweep_cell(seed, index);
  cell.shoe.toe_guard = true;
  return scan_of(cell);
}

/// The worst of these cells with guards.
Judged worst_of(std::initializer_list<std::pair<std::uint64_t, std::uint64_t>> seeds_and_indices) {
  Judged worst = Judged::Right;
  for (const auto& [seed, index] : seeds_and_indices) {
    const SweepScan scan = scan_with_guard(seed, index);
    worst = std::max(worst, judge(scan, bite_line::find_bite_line(scan.cloud, {})).judged);
  }
  return worst;
}

}  // namespace

TEST_GROUP(GuardLines){};

TEST(GuardLines, AFlankThatWasNotSeenMakesItsGapUnsure) {
  // What is left of a flank beside the missing sector says that the line climbs in it.  A course that bridges
  // the sector was wrong without a word on each of these, by 2 to 10 mm over 8 mm and more.
  constexpr std::array<UncertainScanSettings, 3> k_hidden{{
      {.shoe_class = sim::ShoeClass::Pump, .seed = 2012, .missing_mm = 26, .toe_guard = true},
      {.shoe_class = sim::ShoeClass::Wedge, .seed = 2062, .missing_mm = 13, .toe_guard = true},
      {.shoe_class = sim::ShoeClass::Boot, .seed = 2081, .missing_mm = 14, .toe_guard = true},
  }};
  for (const UncertainScanSettings& settings : k_hidden) {
    const UncertainScan made = uncertain_scan(settings);
    CHECK(judge({.cloud = {}, .truth = made.truth}, line_of(made)).judged != Judged::Wrong);
  }
}

TEST(GuardLines, ACourseThatComesBackFarFromWhereItLeftItsCreaseIsLookedAtAsAWhole) {
  // They were wrong without a word, over 34 and 65 mm.
  CHECK(worst_of({{995, 272}, {3014, 70}}) == Judged::Right);
}

TEST(GuardLines, ACapsEdgeAboveAGuardIsNotTheLine) {
  // They were wrong without a word, over 48 to 192 mm.
  CHECK(worst_of({{992, 119}, {3015, 20}, {3015, 289}, {3020, 168}, {3021, 3}}) != Judged::Wrong);
}

TEST(GuardLines, ACornerOfAGuardSaysHowFarItMayBeOff) {
  // It was wrong without a word, over 7 mm.
  CHECK(worst_of({{3013, 205}}) == Judged::Right);
}

TEST(GuardLines, AHollowBelowAGuardThatIsMuchWeakerThanTheLineIsNotTheLine) {
  // It was wrong without a word, over 49 mm and by up to 14 mm.
  CHECK(worst_of({{3019, 154}}) == Judged::Right);
}

TEST(GuardLines, APlaceThatIsDoubtedIsFlaggedThoughNoOtherCreaseIsKnown) {
  // It was wrong without a word over 41 mm: one in eight that the line is elsewhere, and a U95 of 0.05 mm.
  CHECK(worst_of({{26112912, 18}}) != Judged::Wrong);
}

TEST(GuardLines, AGuardFarRoundTheToeIsNoChangeOfCrease) {
  // The guard goes on over more than 120 mm.
  CHECK(worst_of({{3023, 138}, {3023, 142}}) != Judged::Wrong);
}

TEST(GuardLines, WhatWasSeenBelowAGuardAndShowsNoCreaseIsNotTheLine) {
  // They were wrong without a word, over 30 and 37 mm.
  // The third was over 22 mm, with a confidence of 0.6; the last one over 11 mm, where the crease fades
  // beside the bare stretch.
  CHECK(worst_of({{3023, 103}, {3022, 6}, {3029, 275}, {3035, 145}}) != Judged::Wrong);
}

TEST(GuardLines, AWideLookDoesNotMakeADearWayCheap) {
  // With its cost spread over the wide look's length one was wrong over 40 mm, on the guard's own stitches,
  // and one over 34 mm, on the lower edge of a bumper.
  CHECK(worst_of({{3024, 275}, {3025, 101}}) != Judged::Wrong);
}

TEST(GuardLines, AGuideThatSagsInAGapDoesNotPullTheLineDown) {
  // Over 10 mm of a sector it sagged by 2 mm without a word.
  CHECK(worst_of({{3024, 68}}) == Judged::Right);
}

TEST(GuardLines, ALineThatBeginsJustBeforeTheOutlineIsNotStretched) {
  // Its first station lay 0.3 mm before the outline's begin and was counted a turn later: 157 of 220 mm were
  // bridged, it was said; 37 mm of it were not seen.
  const bite_line::Extraction found = bite_line::find_bite_line(scan_with_guard(3028, 106).cloud, {});
  CHECK(found.found || found.refusal->code != bite_line::Refused::TooMuchBridged);
}

}  // namespace biteline::test
