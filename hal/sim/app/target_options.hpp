// SPDX-License-Identifier: MIT
#pragma once
/// \file A live cell that shows targets in place of the shoe: what a head is calibrated by.

#include <csignal>
#include <filesystem>
#include <optional>

#include "common/core/error.hpp"
#include "common/options/command.hpp"
#include "hal/sim/live/live_cell.hpp"

namespace biteline::cell {

struct TargetOptions {
  bool shown{false};
};

void add_target_options(options::Command& command, TargetOptions& options);
[[nodiscard]] std::optional<sim::TargetShowSettings> target_show(const TargetOptions& options);

/// `out`/target.yaml and `out`/two-planes.yaml, as `biteline capture --target` reads them.
[[nodiscard]] Result<void> write_targets(const std::filesystem::path& out);

/// Waits for one of `signals`.  SIGUSR1 takes the head to the next place of the targets, after the last to
/// the first; any other one ends the wait.  Pre: `signals` are blocked.
void wait_for_end(const sigset_t& signals, sim::LiveCell& cell);

}  // namespace biteline::cell
