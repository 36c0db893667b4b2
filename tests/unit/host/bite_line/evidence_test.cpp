// SPDX-License-Identifier: MIT
#include "host/bite_line/layers/evidence.hpp"

#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <cmath>

#include "tests/unit/host/bite_line/drum.hpp"

namespace biteline::bite_line {
namespace {

/// From 0 to 1 within half a millimetre about `z_mm`.
double rise(double z, double z_mm) {
  return 1 / (1 + std::exp(-(z - z_mm) / 0.12));
}

}  // namespace

TEST_GROUP(Evidence){void teardown() override{test::forgive_underflow();
}  // namespace biteline::bite_line
}
;

TEST(Evidence, TheLowerEdgeOfAPieceOnTheUpperIsNoBiteLine) {
  // The sole's edge stands out by 2 mm up to z = 20, a bumper on the upper by as much from z = 35 on.
  const Side side = test::drum_side([](double, double z) { return 2 * (1 - rise(z, 20)) + 2 * rise(z, 35); });
  const Evidence sut = find_evidence(side.field, {});
  const SideGrid& grid = side.field.grid;
  const auto at_crease = [&](int col, double z_mm) {
    std::size_t crease = grid.at(0, col);
    for (int row = 0; row < grid.rows; ++row) {
      const std::size_t cell = grid.at(row, col);
      if (std::abs(grid.z_mm(row) - z_mm) < 2 && side.field.turn_rad[cell] > side.field.turn_rad[crease])
        crease = cell;
    }
    return static_cast<double>(sut.likeness[crease]);
  };
  for (int col = 0; col < grid.cols; col += 17) {
    CHECK_COMPARE(at_crease(col, 20), >, 0.5);
    CHECK_COMPARE(at_crease(col, 35), <, 0.05);
  }
}

}  // namespace biteline::bite_line
