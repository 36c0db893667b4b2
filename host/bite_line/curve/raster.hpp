// SPDX-License-Identifier: MIT
#pragma once
/// \file The unrolled side on a square grid that closes round the shoe, and the directions in which a curve
/// may lead over it.

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

#include "common/geometry/se3.hpp"
#include "host/bite_line/pooled_vector.hpp"
#include "host/bite_line/shoe/outline_lookup.hpp"

namespace biteline::bite_line {

/// From a cell to one near it.
struct CellStep {
  int cols, rows;

  [[nodiscard]] double length() const { return std::hypot(cols, rows); }  ///< in cells
};
/// Some 22.5 degrees apart, anticlockwise: from down and a little back to up and a little back.  No line of
/// a shoe runs back along the outline for long.
inline constexpr std::array<CellStep, 11> k_cell_steps{
    {{-1, -2}, {0, -1}, {1, -2}, {1, -1}, {2, -1}, {1, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 1}, {-1, 2}}};
inline constexpr std::size_t k_directions = k_cell_steps.size();
inline constexpr std::size_t k_level_direction = 5;
inline constexpr std::size_t k_axes = 8;  ///< a direction and the eighth one after it are opposite

/// How far out the surface lies, as a plane about the middle of each cell: alike in all directions, as
/// creases that stand upright need it.  Rows go up; columns go along the outline, and the last one has the
/// first one beside it.  A column's cells lie one after the other.
struct Raster {
  /// A crease of 0.5 mm is told, and a shoe has some 90 000 cells.
  static constexpr double k_cell_mm = 0.75;

  int rows{0};
  int cols{0};
  double z_low_mm{0};
  double col_mm{k_cell_mm};  ///< so that whole ones go round
  PooledVector<float> o_mm;
  PooledVector<float> along_ratio, up_ratio;  ///< the plane's slopes: mm outwards for each mm
  PooledVector<std::uint8_t> seen;

  /// `turn_mm`: the outline's length; what has a negative s is left out.  `points_per_mm2`: where points are
  /// few, planes are wider, and where profiles are far apart, longer.
  [[nodiscard]] static Raster of(std::span<const OutlinePlace> places, double turn_mm, double z_low_mm,
                                 double height_mm, double points_per_mm2);

  [[nodiscard]] std::size_t at(int row, int col) const {
    return static_cast<std::size_t>(col) * static_cast<std::size_t>(rows) + static_cast<std::size_t>(row);
  }
  [[nodiscard]] std::size_t size() const {
    return static_cast<std::size_t>(rows) * static_cast<std::size_t>(cols);
  }
  [[nodiscard]] int round_col(int col) const { return ((col % cols) + cols) % cols; }
  /// The same, quicker, of one less than once round beyond.
  [[nodiscard]] int near_col(int col) const { return col < 0 ? col + cols : col >= cols ? col - cols : col; }
  /// The middle of a cell: s, z; `col` may go beyond the last one, and s then does, too.
  [[nodiscard]] Vec2 place(double row, double col) const {
    return {(col + 0.5) * col_mm, z_low_mm + (row + 0.5) * k_cell_mm};
  }
  [[nodiscard]] double row_of(double z_mm) const { return (z_mm - z_low_mm) / k_cell_mm - 0.5; }
  [[nodiscard]] double col_of(double s_mm) const { return s_mm / col_mm - 0.5; }
};

}  // namespace biteline::bite_line
