// SPDX-License-Identifier: MIT
#pragma once
/// \file `biteline-fleet --list`, `--odd` and `--log-links`: what the database knows, printed.

#include "common/core/error.hpp"
#include "host/fleet/centre.hpp"

namespace biteline::fleet {

[[nodiscard]] Result<ExitStatus> tell_cells(Centre& centre, bool as_json);
/// Cells whose lines differ from the others'; Refused when there is one.
[[nodiscard]] Result<ExitStatus> tell_odd_cells(Centre& centre, bool as_json);
/// A line each, `ROW LINK TIME BOOK`, as memory::read_kept_links() takes them.  Errc::FileNotFound: the cell
/// told none.
[[nodiscard]] Result<ExitStatus> tell_log_links(Centre& centre, const std::string& cell);

}  // namespace biteline::fleet
