// SPDX-License-Identifier: MIT
#include "hal/sim/app/tool_options.hpp"

#include <algorithm>
#include <string_view>

namespace biteline::cell {

void add_tool_options(options::Command& command, ToolOptions& options) {
  const std::vector<std::string> works{sim::k_work_names.begin(), sim::k_work_names.end()};
  options::Option* leaves =
      command
          .add_option("--tool-leaves", options.leaves,
                      "What the arm's tool leaves on the shoe where its output is on, simulated; the next "
                      "scan sees it (default: nothing)")
          ->check(options::one_of(works));
  command
      .add_option("--tool-film", options.film_seed,
                  "Which film of its kind: how high, how dark; the same number makes the same film")
      ->needs(leaves)
      ->capture_default_str();
  command
      .add_option("--tool-output", options.output, "The controller's digital output that the tool hangs on")
      ->check(options::whole_number(0, 7))
      ->needs(leaves)
      ->capture_default_str();
  command
      .add_option("--tool-width", options.width_mm, "Of what it leaves, on the surface, across its way [mm]")
      ->check(options::number({.minimum = 1, .maximum = 40}, "mm"))
      ->needs(leaves)
      ->capture_default_str();
  command
      .add_option("--tool-standoff", options.standoff_mm,
                  "Of the place that is worked, from the tool's tip along its axis [mm]")
      ->check(options::number({.minimum = 0, .maximum = 200}, "mm"))
      ->needs(leaves)
      ->capture_default_str();
  command.add_option("--tool-opens-ms", options.opens_ms, "From its output's switching on until it works")
      ->check(options::number({.minimum = 0, .maximum = 1000}, "ms"))
      ->needs(leaves)
      ->capture_default_str();
  command.add_option("--tool-closes-ms", options.closes_ms, "From its switching off until it works no more")
      ->check(options::number({.minimum = 0, .maximum = 1000}, "ms"))
      ->needs(leaves)
      ->capture_default_str();
  options::Option* gap =
      command
          .add_option(
              "--work-gap", options.gap_mm,
              "A fault: there the tool leaves nothing; its middle along the outline, and its length [mm]")
          ->check(options::number({.minimum = 0, .maximum = 2000}, "mm"))
          ->expected(2)
          ->needs(leaves);
  command
      .add_option("--work-gap-programs", options.gap_programs,
                  "In so many programs that switch the tool on; later ones work there, too")
      ->check(options::whole_number(1, 1000))
      ->needs(gap)
      ->capture_default_str();
}

std::optional<sim::WorkingTool> working_tool(const ToolOptions& options) {
  if (options.leaves.empty()) return std::nullopt;
  const auto named = std::ranges::find(sim::k_work_names, std::string_view{options.leaves});
  sim::WorkingTool tool{
      .work = static_cast<sim::Work>(named - sim::k_work_names.begin()),
      .film_seed = options.film_seed,
      .digital_output = options.output,
      .width_mm = options.width_mm,
      .standoff_mm = options.standoff_mm,
      .gun = {.opens_s = 1e-3 * options.opens_ms, .closes_s = 1e-3 * options.closes_ms, .metered = false},
      .gap_programs = options.gap_programs};
  if (!options.gap_mm.empty())
    tool.gap = sim::OutlinePart{.from_s_mm = options.gap_mm[0] - options.gap_mm[1] / 2,
                                .length_mm = options.gap_mm[1]};
  return tool;
}

}  // namespace biteline::cell
