// SPDX-License-Identifier: MIT
#pragma once
/// \file The shoe's side surface as one picture: eight planes side by side, closed left to right.

#include <array>
#include <cstddef>
#include <vector>

namespace biteline::groove {

/// Row 0 is the top.  Left and right end are the same place of the shoe.
struct Unrolled {
  int rows{0};
  int cols{0};
  double row_mm{0};                   ///< height of a pixel
  double col_mm{0};                   ///< its length along the perimeter
  double top_mm{0};                   ///< height in shoe of the upper edge of row 0
  std::array<int, 8> section_col{};   ///< first column of the sections AB, BC, ... HA
  std::vector<float> value;           ///< mean curvature, 1/mm, row-major; 0 where unknown
  std::vector<unsigned char> known;   ///< 1 where the surface was seen

  [[nodiscard]] std::size_t at(int row, int col) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(cols) + static_cast<std::size_t>(col);
  }
};

}  // namespace biteline::groove
