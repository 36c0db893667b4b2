// SPDX-License-Identifier: MIT
#include <CppUTest/TestHarness.h>

#include "host/bite_line/path/decide.hpp"

namespace biteline::bite_line {
namespace {

Crease crease(double height_mm, double turn_deg, double step_mm) {
  Crease c;
  c.seen_share = 1;
  c.visible_share = 1;
  c.median_turn_rad = turn_deg * 3.14159265 / 180;
  c.median_step_mm = step_mm;
  c.step_share = step_mm > 0.15 ? 1 : 0;
  c.mean_height_mm = height_mm;
  c.evidence = 1 - std::exp(-(turn_deg - 1.5) / 12);
  return c;
}

}  // namespace

TEST_GROUP(Decide){};

TEST(Decide, AGrooveInTheSoleBelowTheSolesEdgeIsDecoration) {
  const Decision sut = decide({crease(15, 70, 0.0), crease(26, 50, 3.0)}, 0.5);
  CHECK_FALSE(sut.refusal.has_value());
  DOUBLES_EQUAL(26, sut.paths.front().mean_height_mm, 1e-9);
}

TEST(Decide, AGrooveBelowASolesEdgeThatIsFilledTooFarIsNotTakenForIt) {
  // As read on a made shoe whose sole has three deep grooves and whose bite line is filled over a third.
  const Crease groove = crease(15, 36, -0.2);
  CHECK_FALSE(decide({groove}, 0.5).refusal.has_value());
  Crease edge = crease(26, 18, 1.3);
  edge.evidence = 0.67;
  edge.visible_share = 0.66;
  edge.longest_gap_mm = 43;
  const Decision sut = decide({groove, edge}, 0.5);
  CHECK(sut.refusal.has_value());
  STRCMP_CONTAINS("on 66 % of its length", sut.refusal->reason.c_str());
}

TEST(Decide, AnUppersOverlayIsNoSolesEdge) {
  // A toe cap's edge stands out as a sole's does, but below it the sole's own edge does, too.
  Crease overlay = crease(38, 18, 1.3);
  overlay.visible_share = 0.55;
  overlay.longest_gap_mm = 200;
  const Decision sut = decide({crease(26, 50, 1.5), overlay}, 0.5);
  CHECK_FALSE(sut.refusal.has_value());
  DOUBLES_EQUAL(26, sut.paths.front().mean_height_mm, 1e-9);
}

TEST(Decide, AWeakStitchLineAboveIsNotTheBiteLine) {
  const Decision sut = decide({crease(26, 70, 3.0), crease(38, 8, 0.0)}, 0.5);
  CHECK_FALSE(sut.refusal.has_value());
  DOUBLES_EQUAL(26, sut.paths.front().mean_height_mm, 1e-9);
}

TEST(Decide, TwoThatLookTheSameAreNamedAndNotChosen) {
  // The lower one has a small step like a sole, the upper one lies above all other creases like a bite line.
  const Decision sut = decide({crease(22, 60, 0.8), crease(34, 60, 0.1)}, 0.5);
  CHECK(sut.refusal.has_value());
  STRCMP_CONTAINS("two candidates", sut.refusal->reason.c_str());
  STRCMP_CONTAINS("22.0", sut.refusal->reason.c_str());
  STRCMP_CONTAINS("34.0", sut.refusal->reason.c_str());
  CHECK(sut.confidence < 0.5);
}

TEST(Decide, ASeamAllTheWayRoundOneSurfaceIsNoBiteLine) {
  // 12 degrees deep and above all else, but the wall goes on below it as above.
  Crease seam = crease(38, 12, 0.4);
  seam.flanks_seen = true;
  seam.flank_turn_rad = -7 * 3.14159265 / 180;
  seam.flank_step_mm = 0.02;
  const Decision alone = decide({seam}, 0.5);
  CHECK(alone.refusal.has_value());
  STRCMP_CONTAINS("within one surface", alone.refusal->reason.c_str());
  CHECK(alone.confidence < 0.5);
  // Nor does it take the place of a flush sole's line, which is no deeper.
  Crease flush = crease(26, 12, 0.3);
  flush.flanks_seen = true;
  flush.flank_turn_rad = 6 * 3.14159265 / 180;
  flush.flank_step_mm = 0.1;
  const Decision both = decide({seam, flush}, 0.5);
  CHECK_FALSE(both.refusal.has_value());
  DOUBLES_EQUAL(flush.mean_height_mm, both.paths.front().mean_height_mm, 1e-9);
}

TEST(Decide, HalfACreaseIsNone) {
  Crease half = crease(26, 60, 3.0);
  half.visible_share = 0.55;
  half.longest_gap_mm = 280;
  const Decision sut = decide({half}, 0.5);
  CHECK(sut.refusal.has_value());
  STRCMP_CONTAINS("no crease all the way round", sut.refusal->reason.c_str());
  STRCMP_CONTAINS("280 mm", sut.refusal->reason.c_str());
}

TEST(Decide, ASmoothFilletIsNoCrease) {
  const Decision sut = decide({crease(26, 3, 3.0)}, 0.5);
  CHECK(sut.refusal.has_value());
  CHECK(sut.confidence < 0.5);
}

TEST(Decide, ASpiralDoesNotClose) {
  Crease spiral = crease(26, 60, 3.0);
  spiral.closure_mm = 12;
  const Decision sut = decide({spiral}, 0.5);
  CHECK(sut.refusal.has_value());
  STRCMP_CONTAINS("does not close", sut.refusal->reason.c_str());
}

TEST(Decide, MostOfTheSideUnseenIsToldAsSuch) {
  Crease seen_half = crease(26, 60, 3.0);
  seen_half.seen_share = 0.5;
  seen_half.visible_share = 0.5;
  seen_half.longest_gap_mm = 300;
  const Decision sut = decide({seen_half}, 0.5);
  CHECK(sut.refusal.has_value());
  STRCMP_CONTAINS("too much is missing", sut.refusal->reason.c_str());
}

TEST(Decide, HalfAShoeIsNotClosedAcrossItsOpening) {
  Crease half = crease(26, 60, 3.0);
  half.seen_share = 0.77;
  half.visible_share = 0.77;
  half.longest_gap_mm = 91;
  half.longest_unseen_mm = 91;
  const Decision sut = decide({half}, 0.5);
  CHECK(sut.refusal.has_value());
  STRCMP_CONTAINS("too much is missing", sut.refusal->reason.c_str());
  STRCMP_CONTAINS("91 mm", sut.refusal->reason.c_str());
}

TEST(Decide, NothingIsNothing) {
  const Decision sut = decide({}, 0.5);
  CHECK(sut.refusal.has_value());
  CHECK(sut.refusal->code == Refused::NoCrease);
}

}  // namespace biteline::bite_line
