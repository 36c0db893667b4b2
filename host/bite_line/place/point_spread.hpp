// SPDX-License-Identifier: MIT
#pragma once
/// \file How far a placed point may be off, as far as its own scan tells: noise, texture, gaps, other layers.

#include "host/bite_line/place/placement.hpp"

namespace biteline::bite_line {

/// In the upright plane across the line: outwards, then up; mm.
struct PointSpread {
  Eigen::Matrix2d covariance_mm2{Eigen::Matrix2d::Zero()};  ///< where the line keeps its layer ...
  double hold{1};                                           ///< ... which it does with this probability
  double within{1};    ///< probability of 0.3 mm and less where it keeps its layer, as its station tells
  double other_mm{0};  ///< how far off the other layer is
};

/// Factors of what the station measured.  `scatter` and `outward` are fitted by
/// tests/bench/line/fit_spread.py to points that bench_line_u95 writes, of seeds that no table shows.  The
/// gap's factors are read off the errors of bridged points (sectors of 8 to 40 mm, made shoes).
struct SpreadModel {
  double scatter{1.07};     ///< of the scatter of neighbouring sections about the line's height
  double outward{0.75};     ///< of the surface's noise
  double any_gap_mm{0.12};  ///< wherever the crease or the surface was not seen
  double gap_mm{0.15};      ///< of a gap's doubt
  /// Of what a sharper course could lie outside.  In 100 gaps of 6 to 44 mm (made shoes of one seed, all
  /// classes) the middle of nine in ten is off by less than 0.29 of it where that is 1 to 4 mm, by 0.17 and
  /// less where it is more: a radius of 0.25, of which this is the deviation.
  double corner{0.1};
  double few{0.75};      ///< of what two halves of few points tell, see half_spread()
  double flat_mm{0.25};  ///< of a flat place's doubt: 1 is one in two within 0.3 mm
};

/// That a station lies within 0.3 mm where it keeps its layer: it was bridged, or jumps, or lies on a flat
/// slope.
[[nodiscard]] double within_of(const PlacedStation& station);

[[nodiscard]] PointSpread spread_of(const PlacedStation& station, const SpreadModel& model = {});

[[nodiscard]] PointSpread between(const PointSpread& a, const PointSpread& b, double fraction);

}  // namespace biteline::bite_line
