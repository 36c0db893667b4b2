// SPDX-License-Identifier: MIT
#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "host/bite_line/find_bite_line.hpp"
#include "host/bite_line/layers/climb.hpp"
#include "host/bite_line/level/branches.hpp"
#include "host/bite_line/level/cheapest_way.hpp"
#include "host/bite_line/level/detours.hpp"
#include "host/bite_line/level/levelled.hpp"
#include "host/bite_line/level/patch.hpp"
#include "host/bite_line/level/place_along.hpp"
#include "host/bite_line/level/rival_ways.hpp"
#include "host/bite_line/level/step_costs.hpp"
#include "host/bite_line/level/way_round.hpp"
#include "host/bite_line/side/side_outline.hpp"
#include "tests/unit/host/bite_line/guard_shoes.hpp"

namespace biteline::test {

namespace {

using bite_line::Cell;
using bite_line::Patch;

/// Once round at a height, but for a stretch that goes straight up, along and straight down again.
std::vector<Vec2> gate(double length_mm, double low_mm, double high_mm) {
  constexpr double k_from_mm = 100, k_to_mm = 130, k_step_mm = 0.5;
  std::vector<Vec2> guide;
  for (double s = 0; s < k_from_mm; s += k_step_mm) guide.emplace_back(s, low_mm);
  for (double z = low_mm; z < high_mm; z += k_step_mm) guide.emplace_back(k_from_mm, z);
  for (double s = k_from_mm; s < k_to_mm; s += k_step_mm) guide.emplace_back(s, high_mm);
  for (double z = high_mm; z > low_mm; z -= k_step_mm) guide.emplace_back(k_to_mm, z);
  for (double s = k_to_mm; s < length_mm - k_step_mm / 2; s += k_step_mm) guide.emplace_back(s, low_mm);
  return guide;
}

/// A level wall of 40 mm by 30 mm with nothing on it.
Patch blank() {
  constexpr std::size_t k_cells = 60 * 80;
  return {.window = {.s_mm = 0, .length_mm = 40, .z_mm = 0, .height_mm = 30},
          .rows = 60,
          .cols = 80,
          .o_mm = std::vector<float>(k_cells, 0.0F),
          .seen = std::vector<std::uint8_t>(k_cells, 1)};
}

constexpr int k_way_row = 30;

/// Over the blank wall a level way costs nearly nothing.  Beside it a detour over `rows` more, of `columns`,
/// costs `worse_mm` more than it.
bite_line::StepCosts costs_of_detour(const Patch& patch, int rows, int columns, double worse_mm) {
  constexpr double k_way_cost = 0.02;
  bite_line::StepCosts costs;
  for (std::vector<float>& of_step : costs) of_step.assign(patch.size(), 1.0F);
  const auto set = [&](int row, int col, double cost) {
    for (std::vector<float>& of_step : costs) of_step[patch.at(row, col)] = static_cast<float>(cost);
  };
  for (int col = 0; col < patch.cols; ++col) set(k_way_row, col, k_way_cost);
  // Up one flank, along, and down the other one.
  const int first = (patch.cols - columns) / 2;
  const int up = rows > 0 ? 1 : -1;
  const double length_mm = (columns + 2 * std::abs(rows)) * Patch::k_cell_mm;
  const double cost = (worse_mm + k_way_cost * columns * Patch::k_cell_mm) / length_mm;
  for (int row = k_way_row + up; row != k_way_row + rows; row += up) {
    set(row, first, cost);
    set(row, first + columns, cost);
  }
  for (int col = first; col <= first + columns; ++col) set(k_way_row + rows, col, cost);
  return costs;
}

/// What speaks against that way.
bite_line::WayDoubt doubt_beside_detour(int rows, int columns, double worse_mm) {
  constexpr int k_from = 5, k_to = 75;
  const Patch patch = blank();
  const bite_line::StepCosts costs = costs_of_detour(patch, rows, columns, worse_mm);
  const bite_line::Way way = bite_line::cheapest_way(patch, costs, {.row = k_way_row, .col = k_from},
                                                     {.row = k_way_row, .col = k_to});
  return bite_line::doubt_way(patch, costs, costs, way, {});
}

bool speaks_against(const bite_line::WayDoubt& doubt) {
  return std::ranges::any_of(doubt.hold, [](float hold) { return hold < 0.5F; });
}

bite_line::StepCosts costs_on(const Patch& patch, const bite_line::StepLookConfig& config = {}) {
  return bite_line::step_costs(patch, bite_line::look_at_steps(patch, config));
}

}  // namespace

TEST_GROUP(Level){};

TEST(Level, ARivalThatIsAboutAsGoodSpeaksAgainstAWay) {
  // 20 mm of the way, so 35 with what is noise: 0.07 of it are 2.45 mm, of which a kink is 2.
  constexpr int k_columns = 40;
  const bite_line::WayDoubt doubt = doubt_beside_detour(-8, k_columns, 0.2);
  CHECK(speaks_against(doubt));
  // The detour's own cells, 4 mm off.
  CHECK(std::ranges::count_if(doubt.hold, [](float hold) { return hold < 0.5F; }) >= k_columns);
  DOUBLES_EQUAL(4.0, static_cast<double>(std::ranges::max(doubt.other_mm)), 0.01);
  CHECK_FALSE(speaks_against(doubt_beside_detour(-8, k_columns, 1.5)));
}

TEST(Level, ARivalFarAboveAWayNeedsAWiderMargin) {
  // 0.16 of 35 mm are 5.6: what is worse by 2 mm counts 4 with its kink.
  constexpr int k_columns = 40;
  CHECK(speaks_against(doubt_beside_detour(12, k_columns, 2)));
  CHECK_FALSE(speaks_against(doubt_beside_detour(-12, k_columns, 2)));
  CHECK_FALSE(speaks_against(doubt_beside_detour(8, k_columns, 2)));
}

TEST(Level, AWayBranchesWhereItTurnsOffACreaseThatGoesStraightOn) {
  // A way along row 30 climbs by 45 degrees to row 50; of the level creases on these two rows some is there.
  constexpr int k_low = 30, k_high = 50, k_climb = 20, k_up = 40, k_last = 80;
  const auto branches = [](int low_to, int high_from) {
    const Patch patch = blank();
    bite_line::StepCosts costs;
    for (std::vector<float>& of_step : costs) {
      of_step.assign(patch.size(), 1.0F);
      for (int col = 0; col < low_to; ++col) of_step[patch.at(k_low, col)] = 0.02F;
      for (int col = high_from; col < patch.cols; ++col) of_step[patch.at(k_high, col)] = 0.02F;
    }
    std::vector<Vec2> way;
    for (int col = 0; col < patch.cols; ++col)
      way.push_back(patch.place(k_low + std::clamp(col - k_climb, 0, k_high - k_low), col));
    return bite_line::branches(patch, costs, way, {});
  };
  const bite_line::Branches both_end = branches(k_climb, k_up);
  CHECK_TEXT(both_end.onto.empty() && both_end.off.empty(), "both creases end where the way turns");
  const bite_line::Branches goes_on = branches(k_last, k_up);
  CHECK(goes_on.onto.empty() && !goes_on.off.empty());
  const auto is_about = [](const std::vector<std::size_t>& at, std::size_t col) {
    constexpr std::size_t k_lever = 12;
    return at.front() <= col && at.back() >= col && at.back() < col + k_lever;
  };
  CHECK(is_about(goes_on.off, k_climb));
  CHECK_TEXT(branches(k_up, k_up).off.empty(), "it fades 10 mm on");
  const bite_line::Branches comes = branches(k_climb, 0);
  CHECK(comes.off.empty() && !comes.onto.empty());
  CHECK(is_about(comes.onto, k_up));
  CHECK_FALSE(goes_on.lie_on_another() || comes.lie_on_another() || branches(k_last, 0).lie_on_another());
}

TEST(Level, AWayThatTurnsOntoACreaseAndOffItLiesOnAnother) {
  CHECK((bite_line::Branches{.onto = {40}, .off = {90}}.lie_on_another()));
  CHECK_FALSE((bite_line::Branches{.onto = {90}, .off = {40}}.lie_on_another()));
}

TEST(Level, WhatLiesBetweenTwoUnsureStretchesIsUnsure) {
  // Twice 10 mm of the way were not seen, 5 mm apart, and then nothing speaks against 10 mm more.
  Patch patch = blank();
  bite_line::StepCosts costs;
  for (std::vector<float>& of_step : costs) of_step.assign(patch.size(), 1.0F);
  for (int row = 0; row < patch.rows; ++row) {
    for (int col = 8; col < 28; ++col) patch.seen[patch.at(row, col)] = 0;
    for (int col = 38; col < 58; ++col) patch.seen[patch.at(row, col)] = 0;
  }
  const bite_line::Way way =
      bite_line::cheapest_way(patch, costs, {.row = 30, .col = 2}, {.row = 30, .col = 77});
  const bite_line::WayDoubt doubt = bite_line::doubt_way(patch, costs, costs, way, {});
  for (std::size_t i = 0; i < way.cells.size(); ++i) {
    const int col = way.cells[i].col;
    if (col >= 8 && col < 58) CHECK(doubt.hold[i] < 0.5F);
    if (col < 7 || col > 58) CHECK(doubt.hold[i] == 1.0F);
  }
}

TEST(Level, APlainCreaseAllAlongAboveAWaySpeaksAgainstIt) {
  // 68 mm of a level way; 10 mm above it another crease that no way leads to.
  const auto doubt = [](float cost_above, float cost_of_way) {
    Patch patch = blank();
    patch.cols = 160;
    patch.window.length_mm = 80;
    patch.o_mm.assign(static_cast<std::size_t>(patch.rows * patch.cols), 0.0F);
    patch.seen.assign(patch.o_mm.size(), 1);
    bite_line::StepCosts costs;
    for (std::vector<float>& of_step : costs) {
      of_step.assign(patch.size(), 2.0F);
      for (int col = 0; col < patch.cols; ++col) {
        of_step[patch.at(20, col)] = cost_of_way;
        of_step[patch.at(40, col)] = cost_above;
      }
    }
    const bite_line::Way way =
        bite_line::cheapest_way(patch, costs, {.row = 20, .col = 12}, {.row = 20, .col = 148});
    return bite_line::doubt_way(patch, costs, costs, way, {});
  };
  CHECK(speaks_against(doubt(0.1F, 0.4F)));
  CHECK_FALSE_TEXT(speaks_against(doubt(0.3F, 0.4F)), "what lies above is not plain");
  CHECK_FALSE_TEXT(speaks_against(doubt(0.1F, 0.1F)), "a plain way has nothing above it");
}

TEST(Level, AThinSoleEndsAtItsRim) {
  // The upper goes out by 45 degrees above a plate's level top of 1.5 mm; below its rim all lies 5 mm in.
  Patch patch = blank();
  constexpr int k_crease_row = 30, k_rim_row = 27;
  for (int col = 0; col < patch.cols; ++col) {
    for (int row = k_crease_row; row < patch.rows; ++row)
      patch.o_mm[patch.at(row, col)] = static_cast<float>((row - k_crease_row) * Patch::k_cell_mm);
    for (int row = 0; row < k_rim_row; ++row) patch.o_mm[patch.at(row, col)] = -5;
  }
  constexpr std::size_t k_along_outline = 0;
  const std::size_t crease = patch.at(k_crease_row, 40);
  const auto cost = [&](double rim_rad) {
    return costs_on(patch, {.flank_mm = 0.5, .rim_rad = rim_rad})[k_along_outline][crease];
  };
  CHECK(cost(0.2) < 0.05F);
  CHECK_TEXT(cost(0) > 0.15F, "what lies below the rim is no flank of the crease");
}

TEST(Level, WhatIsLevelledAndBroughtBackLiesWhereItWas) {
  const bite_line::Side side = side_of(scan_of(with_guard(designed(0))));
  const auto levelled = bite_line::Levelled::along(side, gate(side.outline.length_mm(), 25, 40));
  CHECK(levelled.has_value());
  const bite_line::Shoe level = levelled->shoe();
  CHECK(level.points.size() > side.shoe.points.size() / 2);
  std::vector<float> off_mm;
  for (std::size_t i = 0; i < level.points.size(); i += 50) {
    const auto own = std::lower_bound(side.shoe.index.begin(), side.shoe.index.end(), level.index[i]);
    const Eigen::Vector3f& was = side.shoe.points[static_cast<std::size_t>(own - side.shoe.index.begin())];
    off_mm.push_back((levelled->back(level.points[i].cast<double>()).cast<float>() - was).norm());
  }
  // What lies in the fold of a corner has no place of its own: a part of the two corners' 40 mm.
  std::ranges::sort(off_mm);
  CHECK_TEXT(off_mm[off_mm.size() * 9 / 10] < 0.03F, "nine of ten within the outline's own interpolation");
}

TEST(Level, ABridgeIsAsUnsureAsItsGuideIsOffAtItsEnds) {
  // A gap of ten stations: its guide is off by 1 mm where it ends, and right where it begins.
  bite_line::PlacedLine placed;
  placed.points.resize(100);
  for (std::size_t i = 0; i < 100; ++i) {
    placed.points[i].own_z_mm = i == 60 ? 11.0 : 10.0;
    placed.points[i].to_visible_mm = i > 50 && i < 60 ? 1.0 : 0.0;
  }
  bite_line::doubt_guide_in_gaps(10.0, placed);
  for (std::size_t k = 0; k <= 10; ++k) {
    const double in_gap_mm = k < 10 ? 0.1 * static_cast<double>(k) : 0.0;
    DOUBLES_EQUAL(in_gap_mm, placed.points[50 + k].between_up_mm, 1e-12);
  }
  DOUBLES_EQUAL(0, placed.points[20].between_up_mm, 1e-12);
}

TEST(Level, TheGuideRunsLevelAtItsMeanHeight) {
  const bite_line::Side side = side_of(scan_of(with_guard(designed(0))));
  const std::vector<Vec2> guide = gate(side.outline.length_mm(), 25, 40);
  const auto levelled = bite_line::Levelled::along(side, guide);
  CHECK(levelled.has_value());
  double mean_mm = 0;
  for (const Vec2& place : guide) mean_mm += place.y() / static_cast<double>(guide.size());
  // Up one flank: 8 mm above the foot, and clear of the smoothed corners.
  const Vec2 plan = side.outline.point(100);
  const Vec3 at = side.shoe.T_base_shoe * Vec3{plan.x(), plan.y(), 33};
  const Eigen::Vector3f up = levelled->points(std::vector<Eigen::Vector3f>{at.cast<float>()}).front();
  DOUBLES_EQUAL(mean_mm, static_cast<double>(up.z()), 0.3);
}

TEST(Level, TheCheapestWayGoesRoundWhatIsBarredAndItsCostAddsUp) {
  const Patch patch = blank();
  bite_line::StepCosts costs;
  for (std::vector<float>& of_step : costs) of_step.assign(patch.size(), 1.0F);
  const bite_line::Way straight =
      bite_line::cheapest_way(patch, costs, {.row = 30, .col = 10}, {.row = 30, .col = 70});
  DOUBLES_EQUAL(30.0, straight.cost, 1e-3);
  LONGS_EQUAL(61, straight.cells.size());
  std::vector<std::uint8_t> barred(patch.size(), 0);
  for (int col = 38; col < 43; ++col)
    for (int row = 0; row < 50; ++row) barred[patch.at(row, col)] = 1;
  const bite_line::Way round =
      bite_line::cheapest_way(patch, costs, {.row = 30, .col = 10}, {.row = 30, .col = 70}, barred);
  // From the row 30 up to the row 50 over 14 mm, 2 mm along the top, and down again: 36.4 mm as straight
  // lines.
  CHECK(round.cost > 36.3);
  CHECK(round.cost < 38.0);
  CHECK(std::ranges::none_of(round.cells,
                             [&](const Cell& at) { return barred[patch.at(at.row, at.col)] != 0; }));
}

TEST(Level, AnEdgeCostsWhereItIsCrossedAndNotAlongIt) {
  // A roof: both its sides fall by 45 degrees from an upright edge in the middle.
  Patch patch = blank();
  for (int col = 0; col < patch.cols; ++col)
    for (int row = 0; row < patch.rows; ++row)
      patch.o_mm[patch.at(row, col)] = static_cast<float>(-std::abs(col - 40) * Patch::k_cell_mm);
  const bite_line::StepCosts costs = costs_on(patch);
  constexpr std::size_t k_along_outline = 0, k_up = 4;
  CHECK(costs[k_along_outline][patch.at(30, 40)] > 5);
  // Along it there is nothing, but the edge tells of a crease to its left, which is left above: 0.4 of 0.6.
  DOUBLES_EQUAL(1.24, static_cast<double>(costs[k_up][patch.at(30, 40)]), 0.01);
  DOUBLES_EQUAL(1.0, static_cast<double>(costs[k_along_outline][patch.at(30, 20)]), 0.01);
}

TEST(Level, AnUprightStepIsACreaseForTheWayThatHasTheSoleToItsRight) {
  // The sole's side stands out by 2 mm from the column 40 on.
  Patch patch = blank();
  for (int col = 40; col < patch.cols; ++col)
    for (int row = 0; row < patch.rows; ++row) patch.o_mm[patch.at(row, col)] = col == 40 ? 1.0F : 2.0F;
  const bite_line::StepCosts costs = costs_on(patch);
  constexpr std::size_t k_up = 4, k_down = 12;
  float least_up = 1, least_down = 1;
  for (int col = 36; col < 42; ++col) {
    least_up = std::min(least_up, costs[k_up][patch.at(30, col)]);
    least_down = std::min(least_down, costs[k_down][patch.at(30, col)]);
  }
  CHECK(least_up < 0.1F);
  CHECK(least_down > 0.5F);
}

TEST(Level, AnEdgeRightBelowTellsOfACreaseThatDoesNotShow) {
  // A wall without a crease, whose lower end turns inwards by 45 degrees and is hidden 3 mm on.
  Patch patch = blank();
  constexpr int k_edge_row = 20, k_hidden_rows = 14;
  for (int col = 0; col < patch.cols; ++col) {
    for (int row = 0; row < k_edge_row; ++row)
      patch.o_mm[patch.at(row, col)] = static_cast<float>((row - k_edge_row) * Patch::k_cell_mm);
    for (int row = 0; row < k_hidden_rows; ++row) patch.seen[patch.at(row, col)] = 0;
  }
  const bite_line::StepCosts costs = costs_on(patch);
  constexpr std::size_t k_along_outline = 0, k_back = 8;
  const auto row_above_mm = [&](double mm) {
    return k_edge_row + static_cast<int>(std::lround(mm / Patch::k_cell_mm));
  };
  // A turn of 45 degrees is a plain edge: (1 - 0.6)^2 is left of the cost.
  DOUBLES_EQUAL(0.16, static_cast<double>(costs[k_along_outline][patch.at(row_above_mm(1.5), 40)]), 0.02);
  DOUBLES_EQUAL(1.0, static_cast<double>(costs[k_along_outline][patch.at(row_above_mm(5), 40)]), 0.01);
  CHECK_TEXT(costs[k_back][patch.at(row_above_mm(1.5), 40)] > 0.9F, "an edge above is none of a sole");
}

TEST(Level, APatchIsRightOnASlopeAndAtItsBorder) {
  // A slope of 1 in 2, seen from 10 to 20 mm, in place of a shoe's side.
  constexpr float k_low_mm = 10, k_high_mm = 20, k_every_mm = 0.3F, k_slope = 0.5F;
  bite_line::Side side = side_of(scan_of(with_guard(designed(0), false)));
  side.field.places.clear();
  for (float s = 0; s < 40; s += k_every_mm)
    for (float z = k_low_mm; z < k_high_mm; z += k_every_mm)
      side.field.places.push_back({.s_mm = s, .o_mm = k_slope * z, .z_mm = z});
  const Patch patch = Patch::of(side, {.s_mm = 0, .length_mm = 40, .z_mm = 0, .height_mm = 30}, 0.7);
  // At the border a mean is 0.8 sigma too far in, that is 0.28 mm in o.  The plane's slope is a third too
  // small there at most.
  for (int row = 0; row < patch.rows; ++row) {
    const double z = patch.place(row, 40).y();
    if (z < static_cast<double>(k_low_mm) || z > static_cast<double>(k_high_mm)) continue;
    CHECK(patch.seen[patch.at(row, 40)] != 0);
    DOUBLES_EQUAL(static_cast<double>(k_slope) * z, static_cast<double>(patch.o_mm[patch.at(row, 40)]), 0.1);
  }
}

}  // namespace biteline::test
