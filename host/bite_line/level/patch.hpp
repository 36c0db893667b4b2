// SPDX-License-Identifier: MIT
#pragma once
/// \file A piece of the side on a square grid.

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/geometry/se3.hpp"
#include "host/bite_line/side/side.hpp"

namespace biteline::bite_line {

/// A step from a cell to one near it.
struct GridStep {
  int cols, rows;
};
/// Some 22.5 degrees apart, anticlockwise; the second half leads back.
inline constexpr std::array<GridStep, 16> k_grid_steps{{{1, 0},
                                                        {2, 1},
                                                        {1, 1},
                                                        {1, 2},
                                                        {0, 1},
                                                        {-1, 2},
                                                        {-1, 1},
                                                        {-2, 1},
                                                        {-1, 0},
                                                        {-2, -1},
                                                        {-1, -1},
                                                        {-1, -2},
                                                        {0, -1},
                                                        {1, -2},
                                                        {1, -1},
                                                        {2, -1}}};

struct Cell {
  int row, col;
};

/// The index of the step from a cell to the next one of a way.
[[nodiscard]] std::size_t step_between(const Cell& from, const Cell& to);

/// Part of the unrolled side: from `s_mm` on along the outline, from `z_mm` up.
struct Window {
  double s_mm, length_mm;
  double z_mm, height_mm;
};

/// Rows go up, columns along the outline; a column's cells lie one after the other.
struct Patch {
  static constexpr double k_cell_mm = 0.5;
  Window window;
  int rows{0};
  int cols{0};
  std::vector<float> o_mm;  ///< by planes, alike in both directions, as upright creases need it
  std::vector<std::uint8_t> seen;

  /// `sigma_mm`: of the points' Gaussian weights, more where points are few.
  static Patch of(const Side& side, const Window& window, double sigma_mm);

  [[nodiscard]] std::size_t at(int row, int col) const {
    return static_cast<std::size_t>(col) * static_cast<std::size_t>(rows) + static_cast<std::size_t>(row);
  }
  [[nodiscard]] std::size_t size() const { return o_mm.size(); }
  /// The middle of a cell: s, z.
  [[nodiscard]] Vec2 place(int row, int col) const {
    return {window.s_mm + (col + 0.5) * k_cell_mm, window.z_mm + (row + 0.5) * k_cell_mm};
  }
  /// The cell that holds a place, or the nearest one.
  [[nodiscard]] Cell cell(const Vec2& place) const;
  /// Sets what lies within a reach of a cell to 1, in a value per cell.
  void mark_about(const Cell& at, double reach_mm, std::vector<std::uint8_t>& cells) const;
  [[nodiscard]] static float length_mm(GridStep step) {
    return static_cast<float>(k_cell_mm * std::hypot(step.cols, step.rows));
  }
};

}  // namespace biteline::bite_line
