// SPDX-License-Identifier: MIT
#pragma once
/// \file What makes a point's confidence a probability: of its bridge, its jump and its line.

#include <array>

namespace biteline::bite_line {

/// Of bridges with this spread so many points lie within 0.3 mm.
struct SpreadShare {
  double spread_mm{0};
  double held{0};
};

/// `shares` is fitted by tests/bench/line/fit_confidence.py to bridged points of made shoes with a missing
/// sector (bench_line_confidence --fault sector, seeds 106006, 107007, 108008, 109009 and 119009).
struct ConfidenceModel {
  /// A bridge's spread: this much of how far another course may lie, and what such bridges are off by
  /// elsewhere on the line, in full.  Both may happen at once: they add.
  double corner_ratio{0.1};
  double least_mm{0.05};
  /// Straight between these over the spread's logarithm.  One curve with two numbers does not follow: the
  /// share falls late and at once, and then hardly for a while.  Beyond the last it falls with the square.
  std::array<SpreadShare, 9> shares{{{0.1, 0.999},
                                     {0.35, 0.986},
                                     {0.55, 0.873},
                                     {0.75, 0.659},
                                     {1.05, 0.441},
                                     {1.3, 0.309},
                                     {1.75, 0.265},
                                     {2.3, 0.126},
                                     {4.5, 0.006}}};
  /// A section that lies so far from the running mean over its neighbours is one in two.  Made shoes hold
  /// more, but hardly one jumps.
  double jump_mm{0.8};
  /// However flat the slope, a place beside it holds at least so often as its bridge or jump says, times
  /// this.  Made shoes hold as often as without the slope.  A scanned shoe holds two of five that were seen
  /// and few that were bridged, so that such points stay flagged.
  double flat_held{0.4};
  /// Of the doubt that a written line is the bite line so much is left.  No made line that was written is
  /// wrong, which would leave a fortieth; shoes nobody made may be less alike, so it is a quarter.
  double line_doubt_ratio{0.25};
};

struct BridgeSpread {
  double corner_mm{0};  ///< see PlacedStation
  double tried_mm{0};
};

/// That a bridged place lies within 0.3 mm.
[[nodiscard]] double bridge_held_of(const BridgeSpread& bridge, const ConfidenceModel& model = {});

/// That a place lies within 0.3 mm whose own section is so far from the mean, either way.
[[nodiscard]] double jump_held_of(double jump_mm, const ConfidenceModel& model = {});

/// That a place holds whose crease is so sharp, as far as that tells.
[[nodiscard]] double flat_held_of(double sharp, const ConfidenceModel& model = {});

/// That a written line is the bite line, `of_line` being the product of the decision's gates.
[[nodiscard]] double line_held_of(double of_line, const ConfidenceModel& model = {});

}  // namespace biteline::bite_line
