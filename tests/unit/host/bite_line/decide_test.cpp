// SPDX-License-Identifier: MIT
#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "host/bite_line/path/decide.hpp"

namespace biteline::bite_line {
namespace {

Crease crease(double height_mm, double turn_deg, double step_mm) {
  Crease c;
  c.seen_share = 1;
  c.visible_share = 1;
  c.upper_share = 1;
  c.sole_share = 1;
  c.median_turn_rad = turn_deg * 3.14159265 / 180;
  c.median_step_mm = step_mm;
  c.mean_height_mm = height_mm;
  c.evidence = 1 - std::exp(-(turn_deg - 1.5) / 7);
  return c;
}

Layers layers(const Crease& line, std::vector<Rival> rivals = {}) {
  return {.line = line,
          .hold = std::vector<float>(100, 1.0F),
          .other_mm = std::vector<float>(100, 0.0F),
          .sharp = std::vector<float>(100, 1.0F),
          .rivals = std::move(rivals)};
}

/// As read on a shoe of public origin.
PlanShape shoe_plan() {
  return {.broadest_at = 0.67, .end_breadth = 0.51, .heel_breadth = 0.72};
}

Decision decided(const Layers& of) {
  return decide(of, shoe_plan(), std::nullopt, 0.5);
}

void says_no(Refused code, const Decision& sut) {
  CHECK(sut.refusal.has_value());
  STRCMP_EQUAL(report::refusal_row(code).name, report::refusal_row(sut.refusal->code).name);
  CHECK(sut.confidence < 0.5);
}

/// There is no line.
void refuses(Refused code, const Decision& sut) {
  says_no(code, sut);
  CHECK_FALSE(sut.for_review);
}

/// There is one, and a person must look.
void asks(Refused code, const Decision& sut) {
  says_no(code, sut);
  CHECK(sut.for_review);
}

}  // namespace

TEST_GROUP(Decide){};

TEST(Decide, APlainCreaseBelowAnUpperIsTheBiteLine) {
  const Decision sut = decided(layers(crease(26, 50, 3.0)));
  CHECK_FALSE(sut.refusal.has_value());
  CHECK(sut.confidence > 0.9);
  LONGS_EQUAL(1, sut.paths.size());
}

TEST(Decide, AGrooveBelowASolesEdgeThatIsFilledTooFarIsNotTakenForIt) {
  // As read on a made shoe whose sole has three deep grooves and whose bite line is filled over a third.
  const Crease groove = crease(15, 36, -0.2);
  CHECK_FALSE(decided(layers(groove)).refusal.has_value());
  Crease edge = crease(26, 18, 1.3);
  edge.visible_share = 0.66;
  edge.longest_gap_mm = 43;
  asks(Refused::CutIntoSole, decided(layers(groove, {{.crease = edge, .above = true, .all_round = true}})));
}

TEST(Decide, ALedgeBelowTheEdgeOfANearlyFlushSoleIsNotTakenForIt) {
  // As read on a made shoe: the ledge stands out by 4 mm, the sole at the bite line by 0.3 mm.
  Crease edge = crease(16, 9, 0.3);
  edge.visible_share = 0.9;
  asks(Refused::CutIntoSole,
       decided(layers(crease(11.5, 38, 4.0), {{.crease = edge, .above = true, .all_round = true}})));
}

TEST(Decide, ACollarsEdgeIsNoSolesEdge) {
  const Decision sut = decided(
      layers(crease(35, 46, 0.8), {{.crease = crease(84, 8, 2.2), .above = true, .all_round = true}}));
  CHECK_FALSE(sut.refusal.has_value());
}

TEST(Decide, ALineOnWhatMayBeAnotherLayersIsForReviewWithBothHeights) {
  Layers two = layers(crease(22, 60, 0.8),
                      {{.crease = crease(34, 60, 0.1), .first_col = 40, .cols = 20, .above = true}});
  std::fill_n(two.hold.begin() + 40, 20, 0.1F);
  const Decision sut = decided(two);
  asks(Refused::Rivalled, sut);
  STRCMP_CONTAINS("20 %", sut.refusal->reason.c_str());
  STRCMP_CONTAINS("22.0", sut.refusal->reason.c_str());
  STRCMP_CONTAINS("34.0", sut.refusal->reason.c_str());
}

TEST(Decide, AShortRivalLowersTheConfidenceByItsShare) {
  Layers two = layers(crease(22, 60, 0.8));
  std::fill_n(two.hold.begin() + 40, 5, 0.1F);
  const Decision sut = decided(two);
  CHECK_FALSE(sut.refusal.has_value());
  DOUBLES_EQUAL(0.955 * sut.of_line, sut.confidence, 1e-6);
}

TEST(Decide, EachGateIsToldWithItsLimitAndTheOneThatSaysNoLiesBeyondIt) {
  Crease open = crease(26, 50, 3.0);
  open.upper_share = 0.6;
  const Decision sut = decided(layers(open));
  refuses(Refused::NoUpper, sut);
  for (const SeenGate& gate : sut.gates) {
    const bool beyond = gate.at_most ? gate.value > gate.limit : gate.value < gate.limit;
    CHECK_TEXT(beyond == (gate.sure < 0.5), gate.measure);
    CHECK_TEXT((gate.code == Refused::NoUpper) == beyond, gate.measure);
  }
  const auto upper = std::ranges::find(sut.gates, Refused::NoUpper, &SeenGate::code);
  STRCMP_EQUAL("upper_share", upper->measure);
  DOUBLES_EQUAL(0.6, upper->value, 1e-9);
  DOUBLES_EQUAL(0.8, upper->limit, 1e-9);
}

TEST(Decide, WhatNobodyLookedAtColumnByColumnLacksNothing) {
  CHECK(decided(layers(crease(26, 50, 3.0))).paths.front().lacks.empty());
}

TEST(Decide, ASeamAllTheWayRoundOneSurfaceIsNoBiteLine) {
  // 12 degrees deep and above all else, but the wall goes on below it as above.
  Crease seam = crease(38, 12, 0.4);
  seam.flanks_seen = true;
  seam.flank_turn_rad = -7 * 3.14159265 / 180;
  seam.flank_step_mm = 0.02;
  refuses(Refused::WithinOneSurface, decided(layers(seam)));
  // A flush sole's edge is as weak, and turns the other way.
  seam.flank_turn_rad = 5 * 3.14159265 / 180;
  CHECK_FALSE(decided(layers(seam)).refusal.has_value());
}

TEST(Decide, ALidOverhangs) {
  Crease lid = crease(40, 60, -2.0);
  lid.flanks_seen = true;
  lid.flank_turn_rad = 0.2;
  lid.flank_step_mm = -2.0;
  refuses(Refused::Overhang, decided(layers(lid)));
}

TEST(Decide, AnOpenSandalHasNoUpper) {
  Crease rim = crease(20, 30, 3.0);
  rim.upper_share = 0.4;
  refuses(Refused::NoUpper, decided(layers(rim)));
}

TEST(Decide, BelowTheEdgeOfAPlateThereIsNoSole) {
  Crease edge = crease(2, 60, 3.0);
  edge.sole_share = 0.2;
  refuses(Refused::NoSole, decided(layers(edge)));
}

TEST(Decide, AnOutlineThatIsNoShoesIsToldBeforeAllElse) {
  const Layers sound = layers(crease(26, 50, 3.0));
  const PlanShape box{.broadest_at = 0.5, .end_breadth = 0.93, .heel_breadth = 1};
  refuses(Refused::NotAShoe, decide(sound, box, std::nullopt, 0.5));
  const PlanShape tin{.broadest_at = 0.5, .end_breadth = 0.34, .heel_breadth = 0.6};
  refuses(Refused::NotAShoe, decide(sound, tin, std::nullopt, 0.5));
  const PlanShape iron{.broadest_at = 0.85, .end_breadth = 0.97, .heel_breadth = 0.3};
  refuses(Refused::NotAShoe, decide(sound, iron, std::nullopt, 0.5));
}

TEST(Decide, LessThanHalfACreaseIsNone) {
  Crease half = crease(26, 60, 3.0);
  half.visible_share = 0.45;
  half.longest_gap_mm = 280;
  const Decision sut = decided(layers(half));
  refuses(Refused::NoCreaseAllRound, sut);
  STRCMP_CONTAINS("280 mm", sut.refusal->reason.c_str());
}

TEST(Decide, ACreaseThatShowsOverMostOfItsLengthIsAPersonsToClose) {
  Crease most = crease(26, 60, 3.0);
  most.visible_share = 0.62;
  most.longest_gap_mm = 120;
  const Decision sut = decided(layers(most));
  asks(Refused::NoCreaseAllRound, sut);
  CHECK(sut.of_line > 0.9);  // its gaps are counted where they are bridged
}

TEST(Decide, WhatAHardGateSaysNoToIsNoPersons) {
  Crease torn = crease(26, 60, 3.0);
  torn.sole_share = 0.2;
  Layers layers_torn = layers(torn);
  std::fill_n(layers_torn.hold.begin(), 40, 0.1F);
  refuses(Refused::NoSole, decided(layers_torn));
}

TEST(Decide, GatesThatAllHardlySayYesAskAPerson) {
  Crease hardly = crease(26, 5.4, 3.0);
  hardly.visible_share = 0.71;
  hardly.upper_share = 0.81;
  hardly.sole_share = 0.55;
  const Decision sut = decided(layers(hardly));
  asks(Refused::NotSure, sut);
  STRCMP_CONTAINS("confidence of 0.", sut.refusal->reason.c_str());
}

TEST(Decide, ASmoothFilletIsNoCrease) {
  refuses(Refused::NoCreaseAllRound, decided(layers(crease(26, 3, 3.0))));
}

TEST(Decide, AScanWhoseEndLiesBesideItsBeginDoesNotClose) {
  const Layers sound = layers(crease(26, 60, 3.0));
  CHECK_FALSE(decide(sound, shoe_plan(), std::nullopt, 0.5).refusal.has_value());
  CHECK_FALSE(decide(sound, shoe_plan(), SeamStep{.moved_mm = 0.2}, 0.5).refusal.has_value());
  for (const double moved_mm : {0.6, 3.0}) {
    const Decision sut = decide(sound, shoe_plan(), SeamStep{.moved_mm = moved_mm}, 0.5);
    refuses(Refused::DoesNotClose, sut);
    STRCMP_CONTAINS("where it lay at its begin", sut.refusal->reason.c_str());
  }
}

TEST(Decide, AMovedShoeIsToldAsSuchAndNotAsALineThatIsRivalled) {
  Layers torn = layers(crease(26, 60, 3.0));
  std::fill_n(torn.hold.begin(), 40, 0.1F);
  asks(Refused::Rivalled, decide(torn, shoe_plan(), SeamStep{.moved_mm = 0.1}, 0.5));
  refuses(Refused::DoesNotClose, decide(torn, shoe_plan(), SeamStep{.moved_mm = 4}, 0.5));
}

TEST(Decide, MostOfTheSideUnseenIsToldAsSuch) {
  Crease seen_half = crease(26, 60, 3.0);
  seen_half.seen_share = 0.5;
  seen_half.visible_share = 0.5;
  seen_half.longest_gap_mm = 300;
  refuses(Refused::TooMuchMissing, decided(layers(seen_half)));
}

TEST(Decide, HalfAShoeIsNotClosedAcrossItsOpening) {
  Crease half = crease(26, 60, 3.0);
  half.seen_share = 0.77;
  half.visible_share = 0.77;
  half.longest_gap_mm = 91;
  half.longest_unseen_mm = 91;
  const Decision sut = decided(layers(half));
  refuses(Refused::TooMuchMissing, sut);
  STRCMP_CONTAINS("91 mm", sut.refusal->reason.c_str());
}

TEST(Decide, AStretchThatNobodySawIsBridgedUpTo45Millimetres) {
  Crease bridged = crease(26, 60, 3.0);
  bridged.seen_share = 0.92;
  bridged.visible_share = 0.92;
  for (const double unseen_mm : {40.0, 50.0}) {
    bridged.longest_gap_mm = unseen_mm;
    bridged.longest_unseen_mm = unseen_mm;
    const Decision sut = decided(layers(bridged));
    if (unseen_mm < 45) {
      CHECK_FALSE(sut.refusal.has_value());
    } else {
      refuses(Refused::TooMuchMissing, sut);
    }
  }
}

TEST(Decide, APathWhereNothingWasSeenIsNoMissingSurfaceButNoCrease) {
  // As read on a drawn shoe with a smooth fillet: without a crease the path may lie beside the surface.
  Crease fillet = crease(26, 5.7, 3.0);
  fillet.visible_share = 0.39;
  fillet.seen_share = 0.8;
  fillet.longest_gap_mm = 159;
  fillet.longest_unseen_mm = 96;
  refuses(Refused::NoCreaseAllRound, decided(layers(fillet)));
}

TEST(Decide, NothingIsNothing) {
  Crease nothing = crease(26, 1.5, 0.0);
  nothing.visible_share = 0;
  nothing.longest_gap_mm = 600;
  refuses(Refused::NoCrease, decided(layers(nothing)));
}

}  // namespace biteline::bite_line
