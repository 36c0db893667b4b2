// SPDX-License-Identifier: MIT
#pragma once
/// \file The plan of a shoe's lower side.

#include "host/bite_line/shoe/plan.hpp"
#include "host/bite_line/shoe/shoe.hpp"

namespace biteline::bite_line {

/// Hull of the points up to 45 mm above the lowest: no bite line of the known shoes lies higher at toe or
/// heel.  Points that lie alone draw no hull.
[[nodiscard]] Outline side_outline(const Shoe& shoe);

}  // namespace biteline::bite_line
