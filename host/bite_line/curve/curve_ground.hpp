// SPDX-License-Identifier: MIT
#pragma once
/// \file A shoe's side as curves see it.

#include "host/bite_line/curve/crease_looks.hpp"
#include "host/bite_line/curve/curve_costs.hpp"
#include "host/bite_line/curve/raster.hpp"
#include "host/bite_line/side/side.hpp"

namespace biteline::bite_line {

/// The looks borrow the raster, so it stays where it is.
struct CurveGround {
  CurveGround(Raster of, const CurveWeights& by)
      : raster{std::move(of)}, weights{by}, looks{raster}, costs{curve_costs(raster, looks, weights)} {}
  CurveGround(const CurveGround&) = delete;
  CurveGround& operator=(const CurveGround&) = delete;
  ~CurveGround() = default;

  /// Costs as they are when what this shoe's line usually shows is known.
  void compare_with(const CreaseSigns& usual) {
    looks.compare_with(usual);
    compare_costs(costs, raster, looks);
  }

  Raster raster;
  CurveWeights weights;
  CreaseLooks looks;
  CurveCosts costs;
};

[[nodiscard]] CurveGround curve_ground(const Side& side);

}  // namespace biteline::bite_line
