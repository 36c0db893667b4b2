// SPDX-License-Identifier: MIT
#pragma once
/// \file What a shoe stands on, is held by and lit by.

#include <vector>

#include "hal/sim/shoe/outline.hpp"
#include "hal/sim/shoe/surface_mesh.hpp"
#include "hal/sim/shoe/true_line.hpp"

namespace biteline::sim {

/// A plate under the shoe at z = 0 of its frame, as wide as plate_outline(), the table under the plate, and
/// six pins close to the outline that keep the shoe from sliding.  The pins end below any bite line: they
/// hide nothing of it from a beam that looks down.
void add_surroundings(SurfaceMesh& mesh, const Outline& outline);

/// The plate's edge seen from above, anticlockwise.
[[nodiscard]] std::vector<Vec2> plate_outline(const Outline& outline);
/// How far the plate stands out beyond the shoe's line, at most: what an integrator measures.
[[nodiscard]] double plate_beyond_line_mm(const Outline& outline, const std::vector<TrueLinePoint>& line);

/// Of a hall's lamps behind the head's filter, at the head's own exposure.
inline constexpr double k_hall_grey = 4;

inline constexpr double k_fixture_plate_mm = 10;  ///< thick: the table is so far below the shoe
inline constexpr double k_plate_beyond_mm = 30;   ///< the shoe, all round
inline constexpr double k_pin_height_mm = 8, k_pin_radius_mm = 3, k_pin_gap_mm = 6;

}  // namespace biteline::sim
