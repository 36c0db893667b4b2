// SPDX-License-Identifier: MIT
#pragma once
/// \file Why a head is not accepted.

#include "host/report/refusal.hpp"

namespace biteline::capture {

enum class AcceptRefused {
  BeyondLimit,  ///< a piece is farther off its known size than its limit
};
[[nodiscard]] std::span<const report::RefusalRow<AcceptRefused>> refusal_table(AcceptRefused);

}  // namespace biteline::capture
