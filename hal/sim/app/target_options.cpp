// SPDX-License-Identifier: MIT
#include "hal/sim/app/target_options.hpp"

#include <cstdio>

#include "hal/sim/record/calibration_views.hpp"
#include "hal/sim/record/files.hpp"

namespace biteline::cell {

void add_target_options(options::Command& command, TargetOptions& options) {
  command.add_flag(
      "--targets", options.shown,
      "Ring targets stand before the head in place of the shoe; each SIGUSR1 takes it to their next "
      "place. --out has target.yaml and two-planes.yaml");
}

std::optional<sim::TargetShowSettings> target_show(const TargetOptions& options) {
  if (!options.shown) return std::nullopt;
  return sim::TargetShowSettings{};
}

Result<void> write_targets(const std::filesystem::path& out) {
  BITELINE_TRY(sim::write_file(out / "target.yaml", sim::grid_text(sim::RingGrid{})));
  return sim::write_file(out / "two-planes.yaml", "planes: 2\n" + sim::grid_text(sim::plane_grid()));
}

void wait_for_end(const sigset_t& signals, sim::LiveCell& cell) {
  for (std::size_t place = 0;;) {
    int number = 0;
    sigwait(&signals, &number);
    if (number != SIGUSR1) return;
    if (cell.targets() == nullptr) continue;
    place = (place + 1) % cell.targets()->count();
    cell.show_target(place);
    std::fprintf(stderr, "biteline-cell: place %zu of %zu\n", place + 1, cell.targets()->count());
  }
}

}  // namespace biteline::cell
