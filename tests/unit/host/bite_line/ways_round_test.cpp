// SPDX-License-Identifier: MIT
// Whole made shoes, with a guard on the toe and without one, whose detours are found.
#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "host/bite_line/find_bite_line.hpp"
#include "host/bite_line/layers/climb.hpp"
#include "host/bite_line/level/detours.hpp"
#include "host/bite_line/level/patch.hpp"
#include "host/bite_line/level/way_round.hpp"
#include "host/bite_line/side/side_outline.hpp"
#include "tests/unit/host/bite_line/guard_shoes.hpp"

namespace biteline::test {

namespace {

using bite_line::Patch;

}  // namespace

TEST_GROUP(WaysRound){};

TEST(WaysRound, AWayRoundIsOnTheLineWhereItIsTaken) {
  constexpr int k_shoes = 5;
  int taken = 0;
  for (int k = 0; k < k_shoes; ++k) {
    const SweepScan scan = scan_of(with_guard(designed(k)));
    bite_line::Side side = side_of(scan);
    const bite_line::Layers layers = bite_line::find_layers_along(side, {});
    const std::vector<Vec2> guide = bite_line::way_round(side, layers, {}).places;
    if (guide.empty()) continue;
    ++taken;
    CHECK(guide.front().x() >= 0 && guide.front().x() < side.outline.length_mm());
    DOUBLES_EQUAL(side.outline.length_mm(), guide.back().x() - guide.front().x(), 2 * Patch::k_cell_mm);
    // The side's places of the true line.
    std::vector<Vec2> truth;
    const SE3 T_shoe_base = side.shoe.T_base_shoe.inverse();
    for (const cloud::LinePoint& point : scan.truth.points) {
      const Vec3 at = T_shoe_base * point.position;
      const bite_line::OutlinePlace place = side.outline.locate(Eigen::Vector3f{at.cast<float>()});
      truth.emplace_back(place.s_mm, place.z_mm);
    }
    std::vector<double> off_mm;
    for (const Vec2& place : guide) {
      const double s = std::fmod(place.x(), side.outline.length_mm());
      double nearest = 1e9;
      for (const Vec2& at : truth) nearest = std::min(nearest, (at - Vec2{s, place.y()}).norm());
      off_mm.push_back(nearest);
    }
    std::ranges::sort(off_mm);
    // A cell and its smoothing; a corner of the guard is cut by more.
    CHECK_TEXT(off_mm[off_mm.size() * 95 / 100] < 1.5, "a way round leads elsewhere");
  }
  CHECK_TEXT(taken > 0, "no way round was taken");
}

TEST(WaysRound, AShoeWithNothingPlainAllRoundHasNoWayRound) {
  // A bare upper: nothing concave runs round it.
  SweepCell bare = with_guard(0, false);
  bare.shoe.shoe_class = sim::ShoeClass::Bare;
  bite_line::Side side = side_of(scan_of(bare));
  const bite_line::Layers layers = bite_line::find_layers_along(side, {});
  CHECK(bite_line::way_round(side, layers, {}).places.empty());
}

TEST(WaysRound, AGuardOnTheToeIsGoneRound) {
  int right = 0;
  constexpr int k_shoes = 12;
  for (int k = 0; k < k_shoes; ++k) {
    const SweepScan scan = scan_of(with_guard(designed(k)));
    const SweepVerdict verdict = judge(scan, bite_line::find_bite_line(scan.cloud, {}));
    CHECK(verdict.judged != Judged::Wrong);
    right += verdict.judged == Judged::Right ? 1 : 0;
  }
  // 3 of 4 are, of 300; without detours one of seven.  Of 12, 5 and fewer have a chance of 1 %.
  CHECK_TEXT(right > 5, "hardly a guard was gone round");
}

TEST(WaysRound, AShoeWithoutAGuardHasNoDetour) {
  for (int k = 0; k < 8; ++k) {
    const bite_line::Side made = side_of(scan_of(with_guard(designed(k), false)));
    bite_line::Side side = made;
    const bite_line::Layers layers = bite_line::find_layers_along(side, {});
    CHECK(bite_line::guide_of(side, layers.line, bite_line::find_detours(side, layers, {})).empty());
  }
}

}  // namespace biteline::test
