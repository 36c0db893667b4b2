// SPDX-License-Identifier: MIT
#pragma once
/// \file From placed points and creases to what the extraction hands out, in base.

#include "host/bite_line/extract.hpp"
#include "host/bite_line/path/creases.hpp"
#include "host/bite_line/place/placement.hpp"
#include "host/bite_line/side/side.hpp"

namespace biteline::bite_line {

/// `T_base_shoe` and confidence of the extraction are set.
/// Evenly spaced along the line, in base, with tangents.
[[nodiscard]] cloud::ClosedLine finished_line(const Placement& placement, const Extraction& extraction,
                                              double spacing_mm);

/// Central differences of the closed line's positions.
void add_tangents(cloud::ClosedLine& line);

[[nodiscard]] Candidate candidate_of(const Crease& crease, double confidence, const Side& side);

}  // namespace biteline::bite_line
