// SPDX-License-Identifier: MIT
#pragma once
/// \file Where else the line may run, place by place along a curve, and how likely.

#include <span>
#include <vector>

#include "host/bite_line/curve/curve_rivals.hpp"
#include "host/bite_line/curve/curve_search.hpp"
#include "host/bite_line/curve/raster.hpp"

namespace biteline::bite_line {

/// That a way is the line and the curve beside it is not: two logistic fits to the rows of bench_curve_fit,
/// of ways all round and of ways over a part.
///
/// The bite line is the highest crease between two surfaces.  So of two that go all the way round the upper
/// one is the line, wherever it lies between two surfaces, and however faint it is.
/// Over a part, what was taken wrongly is the upper edge of a cap, a counter or a bumper.  Then another
/// crease lies above it, or the line well below it; and on a shoe whose line is plain elsewhere, it is rare.
struct PosteriorConfig {
  /// Log odds of a way all round above the curve; so much less, below it ...
  double round_above{3.4};
  double round_two_surfaces{9.5};  ///< ... by how much of it lies between two surfaces ...
  double round_more{-0.6};         ///< ... and by what it costs more for each millimetre
  /// Log odds of a way over a part (0.6 less than the fit gives: fewer are wrong on common shoes than on its
  /// own) ...
  double part{-1.7};
  double part_below{1.1};  ///< ... that lies `below_mm` lower or more ...
  double below_mm{6.0};
  double part_crease_above{2.1};  ///< ... by the crease above the curve's stretch ...
  double part_faint{0.85};        ///< ... by the logarithm of what its rest costs for each millimetre ...
  double least_per_mm{0.02};      ///< ... no rest being plainer than so ...
  double part_more{-2.0};         ///< ... and by what the way costs more for each millimetre ...
  double soft_mm{25.0};           ///< ... to which so much is added: a short way must cost something, too
  /// Where nothing is seen, the way that costs as much is as likely.
  double unseen{1.0};
  double unseen_more{-20.0};
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
