// SPDX-License-Identifier: MIT
#include <CppUTest/TestHarness.h>

#include <cmath>

#include "host/bite_line/side/side_normal.hpp"
#include "host/bite_line/side/side_outline.hpp"
#include "tests/unit/host/bite_line/drum.hpp"

namespace biteline::bite_line {
namespace {

constexpr double k_deg = std::numbers::pi / 180;

int row_at(const SideGrid& grid, double z_mm) {
  return static_cast<int>((z_mm - grid.z_low_mm) / grid.row_mm);
}

}  // namespace

TEST_GROUP(SideField){void teardown() override{test::forgive_underflow();
}  // namespace biteline::bite_line
}
;

TEST(SideField, AWallIsAsFarOutAsItIsAndDoesNotTurn) {
  // Leaning: o grows by 0.1 for each mm of height, and the wall swings by a millimetre along it.
  const auto o_of = [](double s, double z) { return 0.1 * z - 3 + 0.5 * std::cos(s / 100); };
  const Side sut = test::drum_side(o_of);
  const SideGrid& grid = sut.field.grid;
  for (int col = 0; col < grid.cols; ++col) {
    for (int row = row_at(grid, 5); row < row_at(grid, 55); ++row) {
      const std::size_t cell = grid.at(row, col);
      CHECK(sut.field.seen[cell] != 0);
      const double s = (col + 0.5) * grid.col_mm;
      if (s < 10 || s > sut.outline.length_mm() - 10) continue;  // o_of has a jump at s = 0
      DOUBLES_EQUAL(o_of(s, grid.z_mm(row)), sut.field.o_mm[cell], 0.05);
      DOUBLES_EQUAL(0, sut.field.turn_rad[cell], 0.5 * k_deg);
    }
  }
}

TEST(SideField, AValleyTurnsConcaveAndARidgeTurnsAsMuchTheOtherWay) {
  const auto turn_at_kink = [](double slope) {
    const Side side = test::drum_side([&](double, double z) { return slope * std::abs(z - 30); });
    const SideGrid& grid = side.field.grid;
    return static_cast<double>(side.field.wide_turn_rad[grid.at(row_at(grid, 30), grid.cols / 4)]);
  };
  const double valley = turn_at_kink(0.3);
  // 33 degrees between the flanks; what the 0.5 mm of smoothing leaves of them over 1.5 mm is some 25.
  CHECK_COMPARE(valley, >, 20 * k_deg);
  CHECK_COMPARE(valley, <, 34 * k_deg);
  DOUBLES_EQUAL(-valley, turn_at_kink(-0.3), 0.5 * k_deg);
}

TEST(SideField, WhereNothingWasScannedNothingIsSeen) {
  const auto hole = [](double s) { return s > 100 && s < 140; };
  const Side sut = test::drum_side([&](double s, double) { return hole(s) ? test::k_no_point : 0.0; });
  const SideGrid& grid = sut.field.grid;
  for (int col = 0; col < grid.cols; ++col) {
    const double s = (col + 0.5) * grid.col_mm;
    const bool seen = sut.field.seen[grid.at(row_at(grid, 30), col)] != 0;
    if (s > 107 && s < 133) CHECK_FALSE(seen);
    if (s < 97 || s > 143) CHECK(seen);
  }
}

TEST(SideField, ALiningBehindTheWallDoesNotPullItIn) {
  Outline outline = test::egg_outline();
  std::vector<Eigen::Vector3f> points = test::drum_points(outline, [](double, double) { return 0.0; });
  const std::size_t of_wall = points.size();
  const auto lining = test::drum_points(outline, [](double, double) { return -6.0; });
  points.insert(points.end(), lining.begin(), lining.end());
  const SideField sut = SideField::build(test::shoe_of(points), outline, {});
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (i >= of_wall) CHECK(sut.places[i].s_mm < 0);
  }
  const std::size_t cell = sut.grid.at(row_at(sut.grid, 30), sut.grid.cols / 3);
  DOUBLES_EQUAL(0, sut.o_mm[cell], 0.05);
}

TEST(SideField, NormalsOfALeaningWallLeanBackAndLookOut) {
  const Side sut = test::drum_side([](double, double z) { return 0.3 * z - 10; });
  const SideGrid& grid = sut.field.grid;
  for (int col = 0; col < grid.cols; col += 7) {
    const auto normal = field_normal(sut, {row_at(grid, 30), col});
    CHECK(normal.has_value());
    const Vec2 out = sut.outline.normal((col + 0.5) * grid.col_mm);
    const Vec3 truth = Vec3{out.x(), out.y(), -0.3}.normalized();
    CHECK_COMPARE(std::acos(std::min(1.0, truth.dot(*normal))), <, 1.0 * k_deg);
  }
  CHECK_FALSE(field_normal(sut, {grid.rows - 1, 0}).has_value());
}

TEST(SideField, TheOutlineIsThatOfTheLowerSideWithoutStrays) {
  const Outline egg = test::egg_outline();
  Shoe shoe = test::shoe_of(test::drum_points(
      egg, [](double, double z) { return z > 50 ? 8.0 : 0.0; }));  // overhanging above the band of 45 mm
  shoe.points.emplace_back(300.0F, 0.0F, 20.0F);
  shoe.index.push_back(0);
  shoe.alone.push_back(1);
  shoe.box.extend(shoe.points.back());
  const Outline sut = side_outline(shoe);
  DOUBLES_EQUAL(egg.length_mm(), sut.length_mm(), 0.01 * egg.length_mm());
  double most_x = 0;
  for (double s = 0; s < sut.length_mm(); s += 1) most_x = std::max(most_x, sut.point(s).x());
  CHECK_COMPARE(most_x, <, 281.0);
}

TEST(SideField, StraysBesideTheSideDoNotWidenItsReach) {
  Outline outline = test::egg_outline();
  std::vector<Eigen::Vector3f> points = test::drum_points(outline, [](double, double) { return 0.0; });
  const std::size_t of_wall = points.size();
  for (std::size_t i = 0; i < of_wall; i += 100) {
    const double s_mm = outline.locate(points[i]).s_mm;
    const Vec2 out = (1.0 + static_cast<double>(i % 7)) * outline.normal(s_mm);
    points.push_back(points[i] +
                     Eigen::Vector3f{static_cast<float>(out.x()), static_cast<float>(out.y()), 0});
  }
  const Shoe shoe = test::shoe_of(points);
  SideField field = SideField::build(shoe, outline, {});
  const Side side{shoe, std::move(outline), std::move(field)};
  const std::vector<Vec2> sut = side_reach(side);
  CHECK(sut.size() > 200);
  for (const Vec2& p : sut) {
    const OutlinePlace at =
        side.outline.locate({static_cast<float>(p.x()), static_cast<float>(p.y()), 20.0F});
    CHECK_COMPARE(std::abs(at.o_mm), <, 0.3F);
  }
}

TEST(SideField, APinBesideTheSideIsNoneOfItsReach) {
  const auto pin = [](double s) { return std::fmod(s + 60, 120) < 8; };
  const Side side = test::drum_side([&](double s, double) { return pin(s) ? 8.0 : 0.0; });
  for (const Vec2& p : side_reach(side)) {
    const OutlinePlace at =
        side.outline.locate({static_cast<float>(p.x()), static_cast<float>(p.y()), 20.0F});
    CHECK_COMPARE(std::abs(at.o_mm), <, 0.8F);  // a tenth of the pin: the field blurs its sides
  }
}

}  // namespace biteline::bite_line
