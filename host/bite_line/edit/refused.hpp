// SPDX-License-Identifier: MIT
#pragma once
/// \file Why a line cannot be mended so.

#include <string>
#include <tl/expected.hpp>

#include "host/report/refusal.hpp"

namespace biteline::edit {

enum class Refused {
  NothingToMend,    ///< the cloud shows no shoe's side
  NoSuchCandidate,  ///< there are fewer
  NoSuchVersion,    ///< no line of this version is kept
  NoLine,           ///< the scan has no line yet: a candidate must be taken first
  BadStretch,       ///< too short, or most of the line
  HintOffSide,      ///< a point lies nowhere on the shoe's side
  HintOutside,      ///< a point lies beside the stretch
  NoCourse,         ///< no course leads through these points
  StillUnsure,      ///< mended, but a person must settle more of the line
  LineCheck,        ///< mended, but no line that a tool could follow
  ScanUnusable,     ///< mended, but what was wrong with the scan itself no hand can mend
};

[[nodiscard]] std::span<const report::RefusalRow<Refused>> refusal_table(Refused);

using Refusal = report::Refusal<Refused>;

template <class T>
using OrRefusal = tl::expected<T, Refusal>;

[[nodiscard]] inline tl::unexpected<Refusal> refuse(Refused code, std::string reason) {
  return tl::unexpected<Refusal>(Refusal{.code = code, .reason = std::move(reason)});
}

}  // namespace biteline::edit
