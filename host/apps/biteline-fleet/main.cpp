// SPDX-License-Identifier: MIT
// biteline-fleet: takes the shoes of all cells from the broker into the centre's database.
#include <sys/prctl.h>

#include <csignal>

#include "host/apps/biteline-fleet/options.hpp"
#include "host/apps/biteline-fleet/running_centre.hpp"
#include "host/apps/biteline-fleet/tables.hpp"
#include "host/fleet/program.hpp"
#include "host/interfaces/accounts/metrics_token.hpp"

namespace biteline::fleet {
namespace {

Result<ExitStatus> carry_out(const FleetOptions& options) {
  BITELINE_TRY(memory::use_time_zone(options.time_zone));
  if (options.drop_metrics_token || !options.metrics_token.empty()) {
    const std::filesystem::path accounts = options.accounts / k_accounts_file;
    BITELINE_TRY(options.drop_metrics_token ? accounts::drop_metrics_token(accounts)
                                            : accounts::use_metrics_token(accounts, options.metrics_token));
    return ExitStatus::Done;
  }
  if (options.runs()) {
    RunningCentre running{options};
    BITELINE_TRY(running.open());
    running.run();
    return ExitStatus::Done;
  }
  BITELINE_ASSIGN(Centre centre, Centre::open(options.database, options.migrations));
  if (options.odd) return tell_odd_cells(centre, options.json);
  if (!options.log_links.empty()) return tell_log_links(centre, options.log_links);
  if (options.list) return tell_cells(centre, options.json);
  if (options.fetches.any()) return carry_out(options.fetches, centre, options.json);
  return carry_out(options.releases, centre, options.json);
}

int run(int argc, char** argv) {
  const ParsedFleetOptions parsed = parse_fleet_options(argc, argv);
  if (parsed.leave_with) return *parsed.leave_with;
  if (parsed.options.exit_with_parent) prctl(PR_SET_PDEATHSIG, SIGTERM);
  const Result<ExitStatus> done = carry_out(parsed.options);
  if (done) return static_cast<int>(*done);
  return log_error(k_fleet_program, to_line(done.error()), error_row(done.error().code).exit_status);
}

}  // namespace
}  // namespace biteline::fleet

int main(int argc, char** argv) {
  return biteline::fleet::run_until_told(biteline::fleet::k_fleet_program, argc, argv, biteline::fleet::run);
}
