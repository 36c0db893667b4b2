// SPDX-License-Identifier: MIT
#pragma once
/// \file From placed points and creases to what the extraction hands out, in base.

#include "host/groove/extract.hpp"
#include "host/groove/path/creases.hpp"
#include "host/groove/place/placement.hpp"
#include "host/groove/side/side.hpp"

namespace biteline::groove {

/// `T_base_shoe` and confidence of the extraction are set.
/// Evenly spaced along the line, in base, with tangents.
[[nodiscard]] line::ClosedLine finished_line(const Placement& placement, const Extraction& extraction,
                                             double spacing_mm);

/// Central differences of the closed line's positions.
void add_tangents(line::ClosedLine& line);

[[nodiscard]] Candidate candidate_of(const Crease& crease, double confidence, const Side& side);

}  // namespace biteline::groove
