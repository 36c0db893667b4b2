// SPDX-License-Identifier: MIT
#pragma once
/// \file The odd cell out: whose lines of one model differ from the other cells', by how much and how sure.
///
/// Each shoe has 36 distances to its model's line.  Their mean and their first harmonic (the line is wider,
/// or lies to one side) are compared with the other cells' medians, in units of their spread (1.4826 MAD,
/// robust: Huber, Robust Statistics, 1981).  A two-sided cumulative sum (Page, Biometrika 41, 1954) names a
/// cell.  Its slack is 0.06 mm, which good heads differ by, and at least half a spread.  By Siegmund's
/// approximation (Sequential Analysis, 1985, overshoot 1.166) one side of one sum with that slack alarms once
/// in 8 million sound shoes.

#include <span>
#include <string>
#include <vector>

#include "host/records/memory/memory.hpp"

namespace biteline::fleet {

/// One shoe of a model, in its cell's order.
struct PlacedShoe {
  std::string cell, scan;
  memory::Places places{};
};

enum class Difference { Wider, AlongFirst, AlongSecond };  ///< mean; cosine and sine of the line's length
[[nodiscard]] const char* to_text(Difference difference);

struct OddCell {
  std::string cell{};
  Difference difference{Difference::Wider};
  /// Against the other cells' median, outwards above 0.  Rather too large at first: it was named for its
  /// large values.
  double mm{0};
  double u95_mm{0};     ///< of that, for shoes that scatter independently
  int shoes{0};         ///< since the difference began
  std::string since{};  ///< the scan with which it began
};

/// The others must have so many shoes, of so many cells, to be compared with.
inline constexpr std::size_t k_least_shoes_of_others = 40;
inline constexpr std::size_t k_least_other_cells = 3;
/// A sum's limit and least slack, in spreads.
inline constexpr double k_limit = 14;
inline constexpr double k_slack = 0.5;
/// Heads that are calibrated well differ by no more.
inline constexpr double k_slack_mm = 0.06;
/// No spread is taken for less: places are written with 0.001 mm.
inline constexpr double k_least_spread_mm = 0.005;

/// Of one model.  Each cell once at most, with its surest difference; empty: none is odd, or too few shoes.
[[nodiscard]] std::vector<OddCell> odd_cells(std::span<const PlacedShoe> shoes);

}  // namespace biteline::fleet
