// SPDX-License-Identifier: MIT
#pragma once
/// \file What makes a point's confidence a probability: of its bridge, its jump and its line.

namespace biteline::bite_line {

/// `power` and `half_mm` are fitted by tests/bench/line/fit_confidence.py to bridged points of made shoes
/// with a missing sector (bench_line_confidence --fault sector, seeds 7021, 7041 and 8011).
struct ConfidenceModel {
  /// A bridge's spread: what such bridges are off by elsewhere on the line, this much of the corner that the
  /// shoe may have there, and of the gap's doubt ...
  double corner_ratio{0.2};
  double doubt_mm{0.15};
  double least_mm{0.05};
  double half_mm{1.303};  ///< ... at which one in two lies within 0.3 mm: a spread is no deviation
  double power{2.222};    ///< how steeply the share falls with it
  /// A section that lies so far from the running mean over its neighbours is one in two.  Made shoes hold
  /// more, but hardly one jumps.
  double jump_mm{0.8};
  /// Of the doubt that a written line is the bite line so much is left.  No made line that was written is
  /// wrong, which would leave a fortieth; shoes nobody made may be less alike, so it is a quarter.
  double line_doubt_ratio{0.25};
};

struct BridgeSpread {
  double corner_mm{0};  ///< see PlacedStation
  double tried_mm{0};
  double doubt{0};
};

/// That a bridged place lies within 0.3 mm.
[[nodiscard]] double bridge_held_of(const BridgeSpread& bridge, const ConfidenceModel& model = {});

/// That a place lies within 0.3 mm whose own section is so far from the mean, either way.
[[nodiscard]] double jump_held_of(double jump_mm, const ConfidenceModel& model = {});

/// That a written line is the bite line, `of_line` being the product of the decision's gates.
[[nodiscard]] double line_held_of(double of_line, const ConfidenceModel& model = {});

}  // namespace biteline::bite_line
