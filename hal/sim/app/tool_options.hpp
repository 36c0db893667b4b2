// SPDX-License-Identifier: MIT
#pragma once
/// \file The options that say what the arm's tool leaves on the shoe of a live cell.

#include <optional>
#include <string>
#include <vector>

#include "common/options/command.hpp"
#include "hal/sim/live/work_trace.hpp"

namespace biteline::cell {

struct ToolOptions {
  std::string leaves{};  ///< empty: nothing
  std::uint64_t film_seed{1};
  int output{0};
  double width_mm{8}, standoff_mm{0};
  double opens_ms{0}, closes_ms{0};
  std::vector<double> gap_mm{};  ///< middle along the outline, length
  int gap_programs{1};
};

void add_tool_options(options::Command& command, ToolOptions& options);
[[nodiscard]] std::optional<sim::WorkingTool> working_tool(const ToolOptions& options);

}  // namespace biteline::cell
