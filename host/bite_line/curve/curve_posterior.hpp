// SPDX-License-Identifier: MIT
#pragma once
/// \file Where else the line may run, place by place along a curve, and how likely.

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "host/bite_line/curve/curve_look.hpp"
#include "host/bite_line/curve/curve_rivals.hpp"
#include "host/bite_line/curve/curve_search.hpp"
#include "host/bite_line/curve/raster.hpp"

namespace biteline::bite_line {

/// What tells which of two ways all round is the line: the bite line is the highest crease between two
/// surfaces.  So it is the upper one, if that lies between two surfaces, however faint it is, and is as faint
/// all round: pieces of seams and overlays that a way leads along are plain here and nothing there.
/// 1, two_surfaces - 1, uneven; negative where the rival is the lower one.
using RoundSigns = std::array<double, 3>;
[[nodiscard]] RoundSigns round_signs(const CurveRival& rival);

/// And over a part.  What was taken wrongly is the edge of a cap, a counter or a bumper.  It costs more than
/// a plain line does, and where it leaves the line, or comes back, it leads over plain surface. 1, and the
/// logarithms of own_per_mm and faintest_per_mm.
using PartSigns = std::array<double, 3>;
[[nodiscard]] PartSigns part_signs(const CurveRival& rival);

/// And of each place of a curve, whatever rivals there are: what was taken wrongly looks unlike the rest of
/// the curve. 1; the logarithm of what the place costs; its rim; the logarithm of what the whole curve costs;
/// how far its rim, and what is below it, are from the curve's usual ones; and the share of the curve that a
/// way beside it passes above, times how much that way lies between two surfaces.
using PlaceSigns = std::array<double, 7>;
/// None of places about which nothing was seen.
[[nodiscard]] std::vector<std::optional<PlaceSigns>> place_signs(const ClosedCurve& curve,
                                                                 std::span<const CurveRival> rivals,
                                                                 const CurveLook& look);

/// That a way is the line and the curve beside it is not, and that a place of the curve is not on it: three
/// logistic fits of `bench_curve_fit --rivals`.
struct PosteriorConfig {
  RoundSigns round{4.85, 9.19, -3.59};
  PartSigns part{-4.00, 0.66, 3.34};
  PlaceSigns place{-2.06, 1.17, 5.13, 1.97, 4.36, 2.05, 4.07};
  /// The fit's shoes are the hard ones.  Of a factory's so many times fewer places are wrong: its odds are
  /// corrected by that (King, Zeng, "Logistic regression in rare events data", Political Analysis 9, 2001).
  double place_rarer{0.1};
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

/// So much more a rival costs for each millimetre than the stretch of the curve beside it, which is taken to
/// be 25 mm longer: a short way must cost something, too.
[[nodiscard]] double more_per_mm(const CurveRival& rival);
[[nodiscard]] bool leads_all_round(const CurveRival& rival, const ClosedCurve& curve);
/// Log odds of a rival against the stretch of the curve that it stands beside.
[[nodiscard]] double log_odds_of(const CurveRival& rival, const ClosedCurve& curve,
                                 const PosteriorConfig& config);

/// Per state of the curve.  Ways that lie within `same_mm` of each other are one.
[[nodiscard]] std::vector<CurveStation> curve_posterior(const Raster& raster, const ClosedCurve& curve,
                                                        std::span<const CurveRival> rivals,
                                                        const CurveLook& look, double same_mm,
                                                        const PosteriorConfig& config);

}  // namespace biteline::bite_line
