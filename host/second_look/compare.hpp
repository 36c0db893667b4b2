// SPDX-License-Identifier: MIT
#pragma once
/// \file The second scan less the first one, cell by cell, between the first one's profiles.

#include <vector>

#include "host/second_look/change.hpp"

namespace biteline::second_look {

/// Of each cell.
struct Compared {
  std::vector<double> variance_ratio{};  ///< of the difference, of one point's; 0: it cannot be compared
  std::vector<double> slope{};           ///< of the first scan's surface: height over way across
};

/// Fills in the differences, and as `variance` the first scan's scatter there.
/// Pre: the rows of `first` are stations, `step_mm` apart.
[[nodiscard]] Compared compare(Change& change, const Raster& first, const Raster& second, double step_mm);

}  // namespace biteline::second_look
