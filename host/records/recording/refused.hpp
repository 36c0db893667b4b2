// SPDX-License-Identifier: MIT
#pragma once
/// \file Why a recording is not taken for what was recorded.

#include "host/report/refusal.hpp"

namespace biteline::recording {

enum class Refused {
  Damaged,    ///< cut, or other bytes than were written
  OtherLink,  ///< whole, but its chain does not end with the link that somebody kept
};

[[nodiscard]] std::span<const report::RefusalRow<Refused>> refusal_table(Refused);

using Refusal = report::Refusal<Refused>;

}  // namespace biteline::recording
