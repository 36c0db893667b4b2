// SPDX-License-Identifier: MIT
#pragma once
/// \file Why a line gets no path.

#include "host/report/refusal.hpp"

namespace biteline::path {

enum class Refused {
  LineUnfit,         ///< the line fails a check before any path is made of it
  CannotFollow,      ///< no joint motion along the whole line
  PathCheckFailed,   ///< a path exists and fails a check
  NoFreeWayToBegin,  ///< from where the arm stands it cannot reach the path's beginning
  NotAsTaught,       ///< another tip or payload is mounted than the process's
};

[[nodiscard]] std::span<const report::RefusalRow<Refused>> refusal_table(Refused);

using Refusal = report::Refusal<Refused>;

}  // namespace biteline::path
