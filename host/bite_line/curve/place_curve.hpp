// SPDX-License-Identifier: MIT
#pragma once
/// \file Whether the best curve of a side is its bite line, and where exactly that lies.

#include <optional>
#include <span>

#include "host/bite_line/curve/curve_on_side.hpp"
#include "host/bite_line/extraction.hpp"
#include "host/bite_line/path/decide.hpp"
#include "host/bite_line/place/placement.hpp"
#include "host/bite_line/scan_points.hpp"
#include "host/bite_line/side/seam_step.hpp"
#include "host/bite_line/side/side.hpp"

namespace biteline::bite_line {

struct PlacedCurve {
  Decision decision;
  PlacedLine placed;  ///< in shoe; empty where there is no line to show
};

/// Sections are upright by the line's definition.  Only where the curve climbs steeply the side is
/// straightened along it first.
[[nodiscard]] PlacedCurve place_curve(const ScanPoints& scan, const Side& side, const CurveOnSide& found,
                                      const std::optional<SeamStep>& seam, const Config& config);

/// The same of a guide that is taken for the line: places (s, z) once round, in the order of s, which may go
/// on beyond the outline's length.  One that does not go round is refused.
[[nodiscard]] OrRefusal<PlacedLine> place_guide(const ScanPoints& scan, const Side& side,
                                                std::span<const Vec2> guide, double spacing_mm);

}  // namespace biteline::bite_line
