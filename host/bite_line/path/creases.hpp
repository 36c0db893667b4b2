// SPDX-License-Identifier: MIT
#pragma once
/// \file What the surface does along a closed path round the shoe's side.

#include <cstdint>
#include <span>
#include <vector>

#include "host/bite_line/side/side_field.hpp"

namespace biteline::bite_line {

/// One closed path and what the surface does along it.  Angles rad, lengths mm.
struct Crease {
  std::vector<double> row;  ///< per column, smooth, in rows of the grid
  std::vector<float>
      turn_rad;  ///< per column: turn of the surface across the path, concave > 0; NaN: not seen
  std::vector<std::uint8_t> visible;  ///< per column: a crease stands out of its surroundings here
  std::vector<std::uint8_t> upper;    ///< per column: seen, and a wall goes on above
  std::vector<std::uint8_t> sole;     ///< per column: seen, and there is something of a sole below
  double seen_share{0};               ///< of the columns: surface was seen at the path
  double visible_share{0};            ///< of the columns: visible
  double longest_gap_mm{0};           ///< longest stretch without a visible crease
  double longest_unseen_mm{0};        ///< longest stretch without any surface at the path
  double median_turn_rad{0};          ///< over the seen columns
  double median_step_mm{
      0};  ///< how far the surface below stands out beyond the one above; sole over upper > 0
  /// The surfaces 2 to 6 mm above and below as straight lines: how much they turn against each other (concave
  /// > 0), and how far the lower one lies outside the upper one where they meet.  What is sewn into one
  /// surface leaves both at 0, or below: a wall is convex.
  bool flanks_seen{false};  ///< on at least a third of the visible columns
  double flank_turn_rad{0};
  double flank_step_mm{0};
  double upper_share{0};  ///< share of the seen columns above which a wall goes on
  double sole_share{0};   ///< share of the seen columns below which there is something of a sole
  double mean_height_mm{0};
  double evidence{0};  ///< mean likeness over the columns, 0 to 1
};

struct CreaseConfig {
  double least_turn_rad{0.06};  ///< 3.5 degrees: less is a fold of cloth, not a crease
  double upper_mm{8.0};         ///< so far above a bite line there is an upper, on pumps and ballerinas too
  double least_sole_mm{1.5};    ///< thick: a sole shows so far below its line, a plate under it does not
  double widest_sole_mm{20.0};  ///< beyond the crease: what stands out farther is no sole but a table's edge
};

/// A path without its steps.
[[nodiscard]] std::vector<double> smooth_rows(const SideGrid& grid, std::span<const int> path);

/// The rows near a path, within `reach_mm`, where the field turns most.
[[nodiscard]] std::vector<int> on_crest(const SideField& field, std::span<const int> path, double reach_mm);

/// What the surface does along a closed path, one row per column; evidence is left at 0.
[[nodiscard]] Crease describe(const SideField& field, std::span<const int> path, const CreaseConfig& config);

}  // namespace biteline::bite_line
