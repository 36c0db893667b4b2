// SPDX-License-Identifier: MIT
#pragma once
/// \file The cheapest curve that a hand leads from place to place.

#include <optional>
#include <span>
#include <vector>

#include "host/bite_line/curve/curve_costs.hpp"
#include "host/bite_line/curve/curve_search.hpp"
#include "host/bite_line/curve/raster.hpp"

namespace biteline::bite_line {

/// The curve passes within `reach_mm` of a place (s, z); s may go on beyond the outline's length.
struct CurveLead {
  Vec2 place;
  double reach_mm;
};

/// The leads between the first and the last one, each put where it makes the way from place to place longer
/// by the least: a hand sets its points in any order.
[[nodiscard]] std::vector<CurveLead> in_order(std::span<const CurveLead> leads);

/// From the first lead to the last one, through all between one after the other, in any direction and as
/// straight as it can be: the energy of CurveSearch.  Its places (s, z).  None where no curve meets every
/// lead.
[[nodiscard]] std::optional<std::vector<Vec2>> led_curve(const Raster& raster, const CurveCosts& costs,
                                                         std::span<const CurveLead> leads,
                                                         const CurveConfig& config);

}  // namespace biteline::bite_line
