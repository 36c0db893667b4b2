// SPDX-License-Identifier: MIT
#include "host/bite_line/layers/climb.hpp"

#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/unit/host/bite_line/drum.hpp"

namespace biteline::bite_line {
namespace {

/// Twice up and down round the shoe, by up to 0.7 mm for each one along.
struct Wave {
  double length_mm{test::egg_outline().length_mm()};
  double amplitude_mm{0.7 * length_mm / (4 * std::numbers::pi)};
  [[nodiscard]] double phase(double s) const { return 4 * std::numbers::pi * s / length_mm; }
  [[nodiscard]] double z_mm(double s) const { return 45 + amplitude_mm * std::sin(phase(s)); }
  [[nodiscard]] double climb(double s) const { return 0.7 * std::cos(phase(s)); }
};

/// A sole that stands out by 1.5 mm below the crease.
double sole_mm(double above_mm) {
  return 1.5 / (1 + std::exp(above_mm / 0.15));
}

}  // namespace

TEST_GROUP(Climb){void teardown() override{test::forgive_underflow();
}  // namespace biteline::bite_line
}
;

TEST(Climb, TheClimbOfACourseIsItsSlope) {
  const Wave wave;
  SideGrid grid{
      .rows = 360, .cols = static_cast<int>(wave.length_mm), .z_low_mm = 0, .row_mm = 0.25, .col_mm = 1};
  grid.col_mm = wave.length_mm / grid.cols;
  std::vector<double> row;
  for (int col = 0; col < grid.cols; ++col)
    row.push_back(wave.z_mm((col + 0.5) * grid.col_mm) / grid.row_mm - 0.5);
  const std::vector<float> sut = climb_of(grid, row);
  for (int col = 0; col < grid.cols; ++col)
    DOUBLES_EQUAL(wave.climb((col + 0.5) * grid.col_mm), sut[static_cast<std::size_t>(col)], 0.02);
}

TEST(Climb, ACreaseThatClimbsIsAsSharpInTheFieldAsALevelOne) {
  const Wave wave;
  const auto steps = test::DrumSteps{.s_mm = 0.7, .z_mm = 0.1, .z_begin_mm = 0, .z_end_mm = 88};
  const Side level = test::drum_side([&](double, double z) { return sole_mm(z - 45); }, steps);
  Side sut = test::drum_side([&](double s, double z) { return sole_mm(z - wave.z_mm(s)); }, steps);
  const auto sharpest = [](const Side& side, int col) {
    const SideGrid& grid = side.field.grid;
    const auto column = side.field.turn_rad.begin() + static_cast<std::ptrdiff_t>(grid.at(0, col));
    return static_cast<double>(*std::max_element(column, column + grid.rows));
  };
  // Where it climbs most.
  const auto steepest = static_cast<int>(0.5 * wave.length_mm / sut.field.grid.col_mm);
  const double plain = sharpest(level, steepest);
  CHECK_COMPARE(sharpest(sut, steepest), <, 0.7 * plain);
  const Layers layers = find_layers_along(sut, {});
  CHECK_COMPARE(sharpest(sut, steepest), >, 0.9 * plain);
  // The hollow lies half a millimetre above the middle of the sole's edge.
  for (int col = 0; col < sut.field.grid.cols; ++col)
    DOUBLES_EQUAL(wave.z_mm((col + 0.5) * sut.field.grid.col_mm) + 0.5,
                  sut.field.grid.z_mm(layers.line.row[static_cast<std::size_t>(col)]), 0.7);
}

TEST(Climb, ACreaseAsHighAsAHeelIsFollowedAboveALevelLedge) {
  // From 75 mm up to 115 mm and down again, below a wall that goes on; a ledge below it is level.
  const double length_mm = test::egg_outline().length_mm();
  const auto z_mm = [&](double s) { return 95 - 20 * std::cos(2 * std::numbers::pi * s / length_mm); };
  const auto steps = test::DrumSteps{.s_mm = 0.7, .z_mm = 0.1, .z_begin_mm = 0, .z_end_mm = 140};
  Side sut =
      test::drum_side([&](double s, double z) { return sole_mm(z - z_mm(s)) + sole_mm(z - 67); }, steps);
  const Layers layers = find_layers_along(sut, {});
  for (int col = 0; col < sut.field.grid.cols; ++col)
    DOUBLES_EQUAL(z_mm((col + 0.5) * sut.field.grid.col_mm) + 0.5,
                  sut.field.grid.z_mm(layers.line.row[static_cast<std::size_t>(col)]), 0.7);
}

}  // namespace biteline::bite_line
