// SPDX-License-Identifier: MIT
#pragma once
/// \file The plan of a shoe's lower side.

#include <vector>

#include "host/bite_line/shoe/plan.hpp"
#include "host/bite_line/shoe/shoe.hpp"
#include "host/bite_line/side/side.hpp"

namespace biteline::bite_line {

/// Hull of the points up to 45 mm above the lowest: no bite line of the known shoes lies higher at toe or
/// heel.  Points that lie alone draw no hull.
[[nodiscard]] Outline side_outline(const Shoe& shoe);

/// How far out the side stands, in shoe, closed and anticlockwise: every two millimetres the place beyond
/// which a tenth of the height lies, up to 45 mm above the lowest point.  Strays beside a surface, and pins
/// and clamps about it, widen the hull; here they count for nothing.
[[nodiscard]] std::vector<Vec2> side_reach(const Side& side);

}  // namespace biteline::bite_line
