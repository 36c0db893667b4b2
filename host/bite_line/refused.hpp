// SPDX-License-Identifier: MIT
#pragma once
/// \file Why a cloud has no bite line, or one that a person must look at first.

#include <tl/expected.hpp>

#include "host/report/refusal.hpp"

namespace biteline::bite_line {

enum class Refused {
  TooFewPoints,      ///< the cloud is next to empty
  NothingConnected,  ///< its points lie apart, nothing of a shoe's size
  NotShoeSized,      ///< what was seen is too long, too short, too broad or too narrow
  NoCrease,          ///< nothing concave runs round the side
  TooMuchMissing,    ///< the surface was not seen over too long a way round
  NoCreaseAllRound,  ///< the crease fades over too long a way
  WithinOneSurface,  ///< the crease is sewn or cut into one surface
  DoesNotClose,      ///< the scan's end shows the shoe beside where its begin did
  NotAShoe,          ///< outline and height are not a shoe's
  NoUpper,           ///< no wall goes on above the crease: an open sandal, a rim
  NoSole,            ///< below the crease there is nothing: it lies where something stands on a table
  Overhang,          ///< what lies above stands out beyond what lies below: a lid
  CutIntoSole,       ///< a crease of the sole: a plain one between two surfaces goes round above it
  Rivalled,          ///< over too much of its length the line may be another crease
  TooMuchUnsure,     ///< too many of its points are below the limit
  TooMuchUncertain,  ///< too many of its points are sure, and yet have a U95 above 1 mm
  TooMuchBridged,    ///< the line is there, but too much of it was not seen
  NotSure,           ///< every gate says yes, and all of them together hardly
};

[[nodiscard]] std::span<const report::RefusalRow<Refused>> refusal_table(Refused);

using Refusal = report::Refusal<Refused>;

/// What a step returns: its value, or why there is none.
template <class T>
using OrRefusal = tl::expected<T, Refusal>;

[[nodiscard]] inline tl::unexpected<Refusal> refuse(Refused code, std::string reason) {
  return tl::unexpected<Refusal>(Refusal{.code = code, .reason = std::move(reason)});
}

}  // namespace biteline::bite_line
