// SPDX-License-Identifier: MIT
#pragma once
/// \file Why a second look tells nothing.

#include <span>

#include "host/report/refusal.hpp"

namespace biteline::second_look {

enum class Refused {
  ShoeMoved,      ///< since the first scan, or nobody can say
  OtherShoe,      ///< another shoe stands there
  NotSeen,        ///< one of the clouds shows too little of the shoe
  NothingToTell,  ///< nowhere along the line the look tells whether it was worked
};

[[nodiscard]] std::span<const report::RefusalRow<Refused>> refusal_table(Refused);

using Refusal = report::Refusal<Refused>;

/// What a person settles: there is an answer, and it is not "all worked".
enum class Settle {
  WorkFaulty,   ///< something is missing, too narrow, too wide, beside or doubled
  StillFaulty,  ///< likewise, after it was worked once more
  WorkUnsure,   ///< no fault, but stretches that nobody can tell of
  WorkRanOut,   ///< from some place on nothing was left, to the path's end
};

[[nodiscard]] std::span<const report::RefusalRow<Settle>> refusal_table(Settle);

/// Why nothing is worked once more.
enum class NoRework {
  NothingMissing,  ///< the look tells of no fault, or of nothing at all
  ForAPerson,      ///< no fault that goes away without working twice what is there
  ReworkedBefore,  ///< once is done by itself; a person decides on more
};

[[nodiscard]] std::span<const report::RefusalRow<NoRework>> refusal_table(NoRework);

}  // namespace biteline::second_look
