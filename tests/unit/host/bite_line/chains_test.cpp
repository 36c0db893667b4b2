// SPDX-License-Identifier: MIT
#include "host/bite_line/layers/chains.hpp"

#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <vector>

namespace biteline::bite_line {

TEST_GROUP(Chains) {
  SideGrid grid{.rows = 100, .cols = 400, .z_low_mm = 0, .row_mm = 0.25, .col_mm = 1.0};
  std::vector<float> likeness = std::vector<float>(grid.size(), 0.0F);

  /// A crease at one height over the columns from..to.
  void crease(int row, int from, int to, float strength = 0.8F) {
    for (int col = from; col < to; ++col) likeness[grid.at(row, col % grid.cols)] = strength;
  }
  float round_at(int row, int col) {
    return share_round(grid, likeness, {})[grid.at(row, col)];
  }
};

TEST(Chains, ACreaseAllRoundGoesRoundAndAPartOfOneByItsPart) {
  crease(20, 0, 400);
  crease(60, 350, 450);  // across the seam
  DOUBLES_EQUAL(1.0, round_at(20, 7), 1e-6);
  DOUBLES_EQUAL(0.25, round_at(60, 7), 1e-6);
  DOUBLES_EQUAL(0.0, round_at(40, 7), 0);
}

TEST(Chains, AGapThatMayBeBridgedDoesNotCutACrease) {
  crease(20, 0, 180);
  crease(22, 220, 400);
  DOUBLES_EQUAL(1.0, round_at(20, 7), 1e-6);
}

TEST(Chains, ALongerGapDoes) {
  crease(20, 0, 150);
  crease(20, 210, 370);  // 60 mm are missing, and 30 mm that are bridged
  DOUBLES_EQUAL((150.0 + 190) / 400, round_at(20, 7), 0.01);
}

TEST(Chains, ATraceThatGoesOnDoesNotMakeAPartAWhole) {
  crease(20, 0, 400, 0.3F);
  crease(20, 0, 100);
  DOUBLES_EQUAL(0.25, round_at(20, 7), 1e-6);
  DOUBLES_EQUAL(1.0, round_at(20, 200), 1e-6);
}

TEST(Chains, WhatRunsIntoAnotherCreaseEndsThere) {
  crease(20, 0, 400);
  // A cap's edge that comes down to the line at both ends.
  for (int col = 100; col < 200; ++col)
    likeness[grid.at(20 + std::min({4 * (col - 99), 40, 4 * (200 - col)}), col)] = 0.9F;
  DOUBLES_EQUAL(1.0, round_at(20, 7), 0.02);
  CHECK(round_at(60, 150) < 0.4F);
}

TEST(Chains, AnEdgeThatRunsUpToACreaseDoesNotTakeItsPlace) {
  // As read on a shoe with a bumper: where its edges come up to the line only one crest is to be seen.
  crease(20, 0, 120);
  crease(20, 124, 196);
  crease(20, 200, 400);
  for (int col = 100; col < 124; ++col) {
    likeness[grid.at((col - 59) / 4, col)] = 0.8F;
    likeness[grid.at((col - 59) / 4, 319 - col)] = 0.8F;
  }
  DOUBLES_EQUAL(1.0, round_at(20, 7), 1e-6);
  DOUBLES_EQUAL(1.0, round_at(20, 160), 1e-6);
  CHECK(round_at(10, 100) < 0.3F);
}

TEST(Chains, ACreaseThatFallsWithinAGapClosesOnItselfAndNotOnAnEdgeAtItsOldHeight) {
  // As read on a shoe with a heel counter: the line falls by 4 mm where a sector is missing, and the upper
  // edge of the counter begins behind it at the height that the line had before.
  crease(60, 240, 400);
  crease(60, 0, 10);
  crease(44, 46, 240);
  for (int col = 200; col < 240; ++col) {
    likeness[grid.at(44, col)] = 0;
    likeness[grid.at(44 + 16 * (col - 199) / 40, col)] = 0.8F;  // and climbs again
  }
  crease(60, 45, 120);
  DOUBLES_EQUAL(1.0, round_at(44, 100), 1e-6);
  DOUBLES_EQUAL(75.0 / 400, round_at(60, 100), 0.01);
}

}  // namespace biteline::bite_line
