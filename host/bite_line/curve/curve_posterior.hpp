// SPDX-License-Identifier: MIT
#pragma once
/// \file Where else the line may run, place by place along a curve, and how likely.

#include <vector>

#include "host/bite_line/curve/curve_search.hpp"
#include "host/bite_line/curve/raster.hpp"
#include "host/bite_line/large.hpp"

namespace biteline::bite_line {

struct PosteriorConfig {
  /// What a place tells, its neighbours tell, too: energies count by so much less than their sum.
  double temperature{2.0};
  double same_mm{2.25};     ///< nearer places are the same crease: placing the line looks so far
  double reach_mm{40.0};    ///< to both sides
  double least_mass{0.02};  ///< a less likely place is no alternative
};

/// Another place that a curve may have, square to it.
struct CurveAlternative {
  Vec2 place;     ///< s, z
  double off_mm;  ///< to the left of the curve; to the right below 0
  double mass;    ///< that the line is there
};

struct CurveStation {
  Vec2 place;                                    ///< s, z; s goes on once round
  double hold{1};                                ///< that the line is on this crease
  std::vector<CurveAlternative> alternatives{};  ///< likeliest first
};

/// `excess`: per cell, see CurveSearch::excess_about(); exp(-excess / temperature) over a section square to
/// the curve, made one, is its probability (min-marginals: Kohli, Torr 2008).  A section ends where the curve
/// itself comes back to it.
[[nodiscard]] std::vector<CurveStation> curve_posterior(const Raster& raster, const ClosedCurve& curve,
                                                        const Large<float>& excess,
                                                        const PosteriorConfig& config);

/// Lets another closed curve count: its own cells cost no more than it does beyond the best one.
void add_rival(const Raster& raster, const ClosedCurve& rival, double more_than_best, Large<float>& excess);

}  // namespace biteline::bite_line
