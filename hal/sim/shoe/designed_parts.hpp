// SPDX-License-Identifier: MIT
#pragma once
/// \file What a designed shoe is put together from, one part each.  All lengths in mm.

#include <cstdint>

#include "hal/sim/shoe/random.hpp"
#include "hal/sim/shoe/shoe_parameters.hpp"

namespace biteline::sim {

/// Streams of random numbers, one per part.
enum DesignStream : std::uint64_t {
  k_outline = 21,
  k_sole,
  k_upper,
  k_decoy,
  k_second,
  k_light,
  k_paint,
  k_guard
};

/// Perimeter of a shoe of length 1; only the spread of things along it depends on it.
constexpr double k_perimeter_ratio = 2.13;
[[nodiscard]] inline double perimeter_mm(const ShoeParameters& shoe) {
  return k_perimeter_ratio * shoe.outline.length_mm;
}

/// A foot's outline, left or right, 90 to 350 mm long.
[[nodiscard]] OutlineShape draw_foot(Random random);

/// The sole of the shoe's class and the crease above it.  `scale`: heights against those of a shoe of 290 mm.
void draw_sole(ShoeParameters& shoe, Random& random, double scale);

/// Adds a decoy to sole or upper.  Where the sole is too thin for it, nothing.
void add_decoy(ShoeParameters& shoe, Decoy decoy, Random random);

/// Lets the sole wrap up over the toe.  Where the upper is too low for it, nothing.
void add_toe_guard(ShoeParameters& shoe, Random random);

[[nodiscard]] Material foam(Random& random);
[[nodiscard]] Material rubber(Random& random);
[[nodiscard]] Material leather(Random& random);
[[nodiscard]] Material cloth(Random& random);

}  // namespace biteline::sim
