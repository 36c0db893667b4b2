// SPDX-License-Identifier: MIT
// The simulated cell: shoe, scanning head, arm.  Nothing here is measured; every output says that it is
// simulated.
#include <cstdio>
#include <exception>
#include <new>

#include "common/system/last_words.hpp"
#include "hal/sim/app/command.hpp"

namespace {

int report_failure(const biteline::Error& error) {
  std::fprintf(stderr, "biteline-cell: %s\n", biteline::to_line(error).c_str());
  return static_cast<int>(biteline::error_row(error.code).exit_status);
}

}  // namespace

int main(int argc, char** argv) {
  biteline::install_last_words("biteline-cell");
  using namespace biteline::cell;
  biteline::options::Command app{
      "Biteline's simulated cell: a made shoe, a scanning head and an arm.  Everything it serves is "
      "simulated.",
      "biteline-cell"};
  Context context;
  app.require_subcommand(1);
  add_serve(app, context);
  add_record(app, context);
  add_record_calibration(app, context);
  add_record_cloud(app, context);

  if (const std::optional<biteline::options::Leave> leave = app.parse(argc, argv)) {
    if (leave->fault.empty()) return 0;
    std::fprintf(stderr, "biteline-cell: %s (see --help)\n", leave->fault.c_str());
    return static_cast<int>(biteline::ExitStatus::BadInput);
  }
  try {
    const biteline::Result<void> result = context.run();
    return result ? 0 : report_failure(result.error());
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr, "biteline-cell: out of memory: raise the limit or free some, then start again\n");
    return static_cast<int>(biteline::ExitStatus::Connection);
  } catch (const std::exception& error) {
    // No exception is meant to arrive here; should one do so, the user still gets one line and no core dump.
    std::fprintf(stderr, "biteline-cell: internal failure: %s\n", error.what());
    return static_cast<int>(biteline::ExitStatus::Connection);
  }
}
