// SPDX-License-Identifier: MIT
#pragma once
/// \file Why a second look tells nothing.

#include <span>

#include "host/records/report/refusal.hpp"

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
  WorkFaulty,  ///< something is missing, too narrow, too wide, beside or doubled
  WorkUnsure,  ///< no fault, but stretches that nobody can tell of
};

[[nodiscard]] std::span<const report::RefusalRow<Settle>> refusal_table(Settle);

}  // namespace biteline::second_look
