// SPDX-License-Identifier: MIT
#pragma once
/// \file `biteline-fleet --fetch`, `--fetches`: recordings that a person wants, beside the running centre.

#include <string>

#include "common/core/error.hpp"
#include "host/fleet/centre.hpp"

namespace biteline::options {
class Command;
}

namespace biteline::fleet {

struct RecordingOrders {
  std::string fetch, mark, unmark;  ///< CELL/SCAN
  bool list{false};

  [[nodiscard]] bool any() const { return !fetch.empty() || !mark.empty() || !unmark.empty() || list; }
};

void add_recording_options(options::Command& app, RecordingOrders& orders);
/// Prints what came of it; Refused where the recording cannot be had.
[[nodiscard]] Result<ExitStatus> carry_out(const RecordingOrders& orders, Centre& centre, bool json);

}  // namespace biteline::fleet
