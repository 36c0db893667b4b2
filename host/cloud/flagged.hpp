// SPDX-License-Identifier: MIT
#pragma once
/// \file How much of a line is flagged, and when that is too much.

#include "host/cloud/closed_line.hpp"

namespace biteline::cloud {

/// A line with more than this flagged is a person's to settle: a tool would work beside the bite line there.
inline constexpr double k_most_flagged_share = 0.1;

/// Shares of a line's points that are flagged, by what flags them.
struct Flagged {
  double unsure{0};     ///< too little confidence
  double uncertain{0};  ///< sure enough, and yet too much U95

  [[nodiscard]] double all() const { return unsure + uncertain; }
  [[nodiscard]] bool too_much() const { return all() > k_most_flagged_share; }
};

/// A point below `min_confidence` counts as flagged, too.
[[nodiscard]] Flagged flagged_of(const ClosedLine& line, double min_confidence = k_sure_ratio);

/// Share of the points that bear the flag, whatever their figures say.
[[nodiscard]] double flagged_share(const ClosedLine& line);

}  // namespace biteline::cloud
