// SPDX-License-Identifier: MIT
#pragma once
/// \file The best closed curve of a shoe's side, and how likely the line is on it, place by place.

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "host/bite_line/curve/curve_ground.hpp"
#include "host/bite_line/curve/curve_posterior.hpp"
#include "host/bite_line/curve/curve_search.hpp"
#include "host/bite_line/scan_points.hpp"
#include "host/bite_line/side/side.hpp"

namespace biteline::bite_line {

/// Log odds that the line is the first of two curves all the way round and not the second, by what they are
/// as wholes.
using AsWhole = std::function<double(std::span<const CurveState>, std::span<const CurveState>)>;

/// A curve, where else the line may run, and how the curve looks.
struct CurveAndRivals {
  ClosedCurve curve;
  std::vector<CurveRival> rivals;
  CurveLook look;
};
/// The cheapest closed curve, or one all round above it that is the likelier line.  What it usually shows is
/// this shoe's line's own look, and the search is done once more by that.
[[nodiscard]] std::optional<CurveAndRivals> best_curve(CurveGround& ground, const CurveConfig& search,
                                                       const AsWhole& as_whole);

/// The best curve on a side, and what is known of it.
struct CurveOnSide {
  ClosedCurve curve;
  double evidence{0};                  ///< mean probability of its places by the surface alone, 0 to 1
  std::vector<CurveStation> stations;  ///< a place of the curve after the other, once round
};

/// Row of the side's grid per column, for places (s, z) one after the other once round: the last one of those
/// that lie in a column.
[[nodiscard]] std::vector<int> rows_along(std::span<const Vec2> places, const SideGrid& grid, double turn_mm);

/// None where the side has none.  `looks`: of the runs that the shoe's points stand for; empty: not known.
[[nodiscard]] std::optional<CurveOnSide> curve_on(const Side& side, std::span<const RunLook> looks);

}  // namespace biteline::bite_line
