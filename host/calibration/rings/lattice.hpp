// SPDX-License-Identifier: MIT
#pragma once
/// \file Marks sorted into rows and columns, before it is known which row is the target's first.

#include <limits>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "host/calibration/rings/grid.hpp"

namespace biteline::calibration {

using Cell = std::pair<int, int>;             ///< (row, col) in a lattice of its own origin and orientation
using Lattice = std::map<Cell, std::size_t>;  ///< to the ring's index

struct Extent {
  int min_row{std::numeric_limits<int>::max()}, max_row{std::numeric_limits<int>::min()};
  int min_col{std::numeric_limits<int>::max()}, max_col{std::numeric_limits<int>::min()};

  void include(Cell cell) {
    min_row = std::min(min_row, cell.first);
    max_row = std::max(max_row, cell.first);
    min_col = std::min(min_col, cell.second);
    max_col = std::max(max_col, cell.second);
  }
  [[nodiscard]] int rows() const { return max_row - min_row + 1; }
  [[nodiscard]] int cols() const { return max_col - min_col + 1; }
  [[nodiscard]] bool fits(const RingTarget& target) const {
    return (rows() <= target.rows && cols() <= target.cols) ||
           (rows() <= target.cols && cols() <= target.rows);
  }
};

[[nodiscard]] Extent extent_of(const Lattice& lattice);

/// Fit in units of the pitch, to the rings' centres.
[[nodiscard]] std::optional<Mat3> lattice_homography(const Lattice& lattice, const std::vector<Ring>& rings);

/// As lattice_homography(), but of the rings within `reach` cells: there lens distortion hardly bends the
/// lattice.
[[nodiscard]] std::optional<Mat3> local_homography(const Lattice& lattice, const std::vector<Ring>& rings,
                                                   Cell about, int reach);

/// A reading of a lattice: quarter turns, then a shift that puts it on the target.
struct Numbering {
  int quarter_turns{0};
  int row_shift{0}, col_shift{0};

  [[nodiscard]] Cell apply(Cell cell) const {
    for (int i = 0; i < quarter_turns; ++i) cell = {cell.second, -cell.first};
    return {cell.first + row_shift, cell.second + col_shift};
  }
};

/// All that put every mark of the lattice onto the target.
[[nodiscard]] std::vector<Numbering> numberings(const Lattice& lattice, const RingTarget& target);

/// The lattice under the first of `readings`; nothing when there is none, or when there are too few marks.
[[nodiscard]] std::optional<GridView> numbered(const Lattice& lattice, const std::vector<Ring>& rings,
                                               const RingTarget& target,
                                               const std::vector<Numbering>& readings);

}  // namespace biteline::calibration
