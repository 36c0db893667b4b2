// SPDX-License-Identifier: MIT
#pragma once
/// \file Why an upper does not get a sample's line.

#include <optional>

#include "host/bite_line/side/seam_step.hpp"
#include "host/report/refusal.hpp"

namespace biteline::transfer {

enum class Refused {
  SampleUnusable,         ///< its cloud holds no shoe, or next to nothing above its line
  UpperWithoutShoe,       ///< the upper's cloud holds no surface of a shoe's size
  DoesNotClose,           ///< the upper moved while it was scanned
  TooLittleOverlap,       ///< the two scans share too little surface
  DirectionNotFixed,      ///< the common surface lets the upper slide in one direction
  OtherFoot,              ///< mirrored, it fits
  OtherSize,              ///< graded, it fits
  UpsideDown,             ///< turned over, it fits
  OtherModel,             ///< the shapes differ, and nothing above explains it
  AlignmentNotConverged,  ///< the search for the place did not settle
  LineNotMet,             ///< no ray from the sample's line meets the upper
  LineHardlySeen,         ///< the scan shows too small a share of the line
  ScanHasGap,             ///< a gap on the line is too long to be bridged
  TooMuchUnsure,          ///< too much of the carried line is flagged
  SeveralModelsFit,       ///< without --sample: two models fit
  ModelNotSure,           ///< without --sample: one model fits, but not well enough to be named
  NoModelFits,            ///< without --sample: none fits
  OrderDisagrees,         ///< another model, foot or size was ordered than the shape shows
};

[[nodiscard]] std::span<const report::RefusalRow<Refused>> refusal_table(Refused);

using Refusal = report::Refusal<Refused>;

/// Nothing where the upper stood still while it was scanned, or nobody can tell.
[[nodiscard]] std::optional<Refusal> why_moved(const std::optional<bite_line::SeamStep>& seam);

}  // namespace biteline::transfer
