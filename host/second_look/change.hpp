// SPDX-License-Identifier: MIT
#pragma once
/// \file What changed from the first scan to the second, against the surface that nobody worked, in units of
/// its own noise.

#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "host/second_look/raster.hpp"

namespace biteline::second_look {

/// Variance of what says nothing.
inline constexpr double k_says_nothing = std::numeric_limits<double>::infinity();

/// Cells across that belong to the planned band, and those that serve as unworked surface.
struct Zones {
  std::size_t low_cell{0}, end_cell{0};  ///< of the plan
  /// From both ends of the raster to here nobody should have worked.
  std::size_t below_end_cell{0}, above_first_cell{0};
};

/// Differences, second less first.  Rows are the second scan's; where a cell, or its row, cannot be
/// compared its `variance` is 0; where one channel says nothing, that one's is infinite.
struct Change {
  Across across{};
  std::vector<double> along_mm{};    ///< of each row on the line, rising
  bool stripe{false};                ///< amplitude and width count, too
  std::vector<Values> value{};       ///< less the unworked surface's in that row
  std::vector<Values> variance{};    ///< of each, as it counts in sums over the band
  std::vector<std::uint8_t> seen{};  ///< per row: it can be compared
  /// Of that variance: how much more it is in sums over a millimetre, where a surface's own grain counts.
  Values patch_ratio{1, 1, 1};
  double log_light{0};  ///< of the amplitudes on unworked surface

  [[nodiscard]] std::size_t rows() const { return along_mm.size(); }
  [[nodiscard]] std::size_t at(std::size_t row, std::size_t cell) const { return row * across.cells + cell; }
  [[nodiscard]] bool known(std::size_t k) const { return variance[k][k_height] > 0; }
  [[nodiscard]] bool known(std::size_t k, std::size_t channel) const {
    return known(k) && std::isfinite(variance[k][channel]);
  }
};

/// Unworked cells of a row: below the plan and above it.  `take` gets the cell, and whether it is below.
template <class Take>
void for_unworked(const Change& change, const Zones& zones, std::size_t row, std::size_t channel,
                  Take&& take) {
  for (std::size_t j = 0; j < change.across.cells; ++j) {
    if (j >= zones.below_end_cell && j < zones.above_first_cell) continue;
    const std::size_t k = change.at(row, j);
    if (change.known(k, channel)) take(k, j < zones.below_end_cell);
  }
}

/// The noise is that of the unworked cells: of single ones, and of what they have in common across (a profile
/// that lies off, a grain wider than a cell, an arm that does not repeat its way).
/// Pre: the rows of `first` are stations, `step_mm` apart.
[[nodiscard]] Change change_of(const Raster& first, const Raster& second, const Zones& zones, double step_mm,
                               bool stripe);

}  // namespace biteline::second_look
