// SPDX-License-Identifier: MIT
#pragma once
/// \file Whether the shoe stood still.

#include "common/core/fixed_text.hpp"

namespace biteline::bite_line {

/// What the scan's end shows otherwise than its begin.
struct SeamStep {
  double out_mm{
      0};  ///< how far out the surface lies at the end beyond where it lay at the begin, at the seam
  double moved_mm{0};  ///< of the place of the outline that moved farthest, if the shoe moved as one in plan
};

/// Sound scans have read 0.36 mm at most, those on the softest arms; in the light of a real laser 0.27
/// (docs/line.md).
inline constexpr double k_most_moved_mm = 0.5;

/// Why a scan with such a step gets no line.
[[nodiscard]] FixedText<240> does_not_close(const SeamStep& step);

}  // namespace biteline::bite_line
