// SPDX-License-Identifier: MIT
#pragma once
/// \file The exact place of a line that was found on a straightened side.

#include "host/bite_line/path/layers.hpp"
#include "host/bite_line/place/placement.hpp"
#include "host/bite_line/place/straightened.hpp"
#include "host/bite_line/scan_points.hpp"
#include "host/bite_line/side/side.hpp"

namespace biteline::bite_line {

/// What was found on `straightened`: a path, a row per column of its grid, and what is known of its layers.
struct FoundLevel {
  const Straightened& straightened;
  const SideGrid& grid;
  std::span<const double> path_row;
  const Layers& layers;
};

/// The line in shoe.  A guide is smooth, and cuts the corners of the line that was found along it.  So the
/// side is straightened anew along that line, twice: then hardly a corner is left.  A guide also runs on
/// where no crease is seen, so the line does not: before the second time it is carried across such gaps.
///
/// The definition's section is upright, and here it is square to the line.  Up to a climb of 60 degrees its
/// curvature is read as the upright one has it; what remains is part of the line's uncertainty.  A line that
/// turns back on itself is refused.
[[nodiscard]] OrRefusal<PlacedLine> place_along(const ScanPoints& scan, const Side& side,
                                                const FoundLevel& found, double spacing_mm);

/// What is bridged follows the guide, which runs at `guide_z_mm`.  Where a gap's end lies off it, the guide
/// was led astray there, and so it may be in the gap: by as much at this end, and by nothing at the other
/// one.  The stations are those of the straightened side.
void doubt_guide_in_gaps(double guide_z_mm, PlacedLine& placed);

/// A side straightened along a guide.
[[nodiscard]] Side side_along(const Straightened& straightened);

}  // namespace biteline::bite_line
