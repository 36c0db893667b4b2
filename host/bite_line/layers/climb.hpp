// SPDX-License-Identifier: MIT
#pragma once
/// \file How steeply the creases of a side climb along the outline, as those of a pump's shank do, and how
/// high.

#include <span>
#include <vector>

#include "host/bite_line/layers/layers.hpp"
#include "host/bite_line/side/side.hpp"

namespace biteline::bite_line {

/// Height over length along the outline, per column; `row`: a course, per column.  What is shorter than some
/// 10 mm does not count: a course that changes its crease is no climb.
[[nodiscard]] std::vector<float> climb_of(const SideGrid& grid, std::span<const double> row);

/// find_layers(), on a side that is smoothed along its creases.  Where these climb by more than the field's
/// own smoothing in height, a level mean along the outline would wash them out: then the side is read once
/// more, along the best course's climb, and its layers are found in that.  Creases of a sole run side by
/// side, so the climb is right even where that course lies on another one.
/// The field of a low shoe ends well above its line.  Where the best course comes close to that end, or the
/// surface begins close below it, as over a high heel, the side is read higher, up to 150 mm.
/// `looks`: of the runs that the shoe's points stand for; empty: not known.
[[nodiscard]] Layers find_layers_along(Side& side, const LayersConfig& config,
                                       std::span<const RunLook> looks = {});

}  // namespace biteline::bite_line
