// SPDX-License-Identifier: MIT
#pragma once
/// \file From what was claimed to what holds: the one map that makes a point's confidence a probability.

#include <array>

namespace biteline::bite_line {

/// Fitted by tests/bench/line/fit_confidence.py to 1620 made shoes of bench_line_confidence --seed 502.
struct ConfidenceModel {
  /// Of points whose crease jumps, or which are bridged, that claim so much ...
  std::array<double, 8> claimed{0, 0.2, 0.4, 0.5, 0.6, 0.8, 0.95, 1};
  /// ... this share lies within 0.3 mm.  Straight lines between.  Hardly a point claims less than 0.2, so
  /// that end is not fitted: what claims nothing holds nothing.
  std::array<double, 8> held{0, 0.277, 0.442, 0.688, 0.833, 0.852, 0.966, 1};
  /// Of the doubt that a written line is the bite line so much is left.  None of the 1620 lines was wrong,
  /// which would leave a fortieth; shoes nobody made may be less alike, so it is a quarter.
  double line_doubt_ratio{0.25};
};

/// `claimed` 0 to 1; rises with it, and leaves 1 as it is.
[[nodiscard]] double held_of(double claimed, const ConfidenceModel& model = {});

/// That a written line is the bite line, `of_line` being the product of the decision's gates.
[[nodiscard]] double line_held_of(double of_line, const ConfidenceModel& model = {});

}  // namespace biteline::bite_line
