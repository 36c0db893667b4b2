// SPDX-License-Identifier: MIT
#pragma once
/// \file Where else the line may run, place by place along a curve, and how likely.

#include <span>
#include <vector>

#include "host/bite_line/curve/curve_rivals.hpp"
#include "host/bite_line/curve/curve_search.hpp"
#include "host/bite_line/curve/raster.hpp"

namespace biteline::bite_line {

/// That a way is the line and the curve beside it is not: a logistic function of how much more it costs for
/// each millimetre, `soft_mm` being added to its length, so that a short way must cost something, too.
/// Chosen by hand on the rows of bench_curve_fit.
///
/// The bite line is the highest crease between two surfaces.  So of two that go all the way round the upper
/// one is the line wherever it is one at all: of 31 pairs all.  Over a part of the way it is the other way
/// round: what was taken wrongly is the upper edge of a cap, a counter or a bumper, and the line runs well
/// below it.
struct PosteriorConfig {
  double soft_mm{25.0};
  /// A way that costs so much more is as likely as the curve ...
  double even{0.05};
  double even_below{0.35};  ///< ... one that lies `below_mm` lower
  double below_mm{6.0};
  double even_round{0.45};  ///< ... and one that goes all the way round above it; so much less, below it
  double steepness{20.0};   ///< of the log odds
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

/// What tells a rival from the stretch of the curve beside it: so much more it costs for each millimetre.
[[nodiscard]] double more_per_mm(const CurveRival& rival, double soft_mm);
[[nodiscard]] bool leads_all_round(const CurveRival& rival, const ClosedCurve& curve);
/// Log odds of a rival against the stretch of the curve that it stands beside.
[[nodiscard]] double log_odds_of(const CurveRival& rival, const ClosedCurve& curve,
                                 const PosteriorConfig& config);

/// Per state of the curve.  Ways that lie within `same_mm` of each other are one.
[[nodiscard]] std::vector<CurveStation> curve_posterior(const Raster& raster, const ClosedCurve& curve,
                                                        std::span<const CurveRival> rivals, double same_mm,
                                                        const PosteriorConfig& config);

}  // namespace biteline::bite_line
