// SPDX-License-Identifier: MIT
#pragma once
/// \file The simulated cell with its page: scan after scan, until somebody ends it.

#include <atomic>

#include "host/apps/biteline-demo/cell_run.hpp"

namespace biteline::demo {

struct LiveOptions {
  CellOptions cell;
  std::string address;  ///< ADDRESS:PORT of the page; empty: biteline-web's own default
};

/// Starts cell, sensor, service and page; prints the page's address with a one-time token on stdout.
/// Returns once `stop` is set; fails when the page cannot be opened or the service ends.
[[nodiscard]] Result<ExitStatus> run_live(const LiveOptions& options, const std::atomic<bool>& stop);

}  // namespace biteline::demo
