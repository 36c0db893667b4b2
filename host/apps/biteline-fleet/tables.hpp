// SPDX-License-Identifier: MIT
#pragma once
/// \file `biteline-fleet --list` and `--odd`: what the database knows, printed.

#include "common/core/error.hpp"
#include "host/fleet/centre.hpp"

namespace biteline::fleet {

[[nodiscard]] Result<ExitStatus> tell_cells(Centre& centre, bool as_json);
/// Cells whose lines differ from the others'; Refused when there is one.
[[nodiscard]] Result<ExitStatus> tell_odd_cells(Centre& centre, bool as_json);

}  // namespace biteline::fleet
