// SPDX-License-Identifier: MIT
// The tool: replay, extract, calibrate, transfer, plan, evaluate, explain, target, model, doctor.
#include <cstdio>
#include <exception>
#include <new>

#include "common/system/last_words.hpp"
#include "host/apps/biteline/command.hpp"

namespace {

int report_failure(const biteline::Error& error) {
  std::fprintf(stderr, "biteline: %s\n", biteline::to_line(error).c_str());
  return static_cast<int>(biteline::error_row(error.code).exit_status);
}

}  // namespace

int main(int argc, char** argv) {
  biteline::install_last_words("biteline");
  using namespace biteline::app;
  CLI::App app{"Biteline: finds a shoe's bite line in laser scans and plans a tool path along it.",
               "biteline"};
  Context context;
  app.require_subcommand(1);
  app.fallthrough();
  app.add_flag("--quiet", context.options.quiet, "No progress, no words beyond the result");
  app.add_flag("--json", context.options.json, "Results on stdout as JSON");
  add_target(app, context);
  add_transfer(app, context);
  add_demo(app, context);
  add_doctor(app, context);
  add_evaluate(app, context);
  add_explain(app, context);
  add_extract(app, context);
  add_calibrate(app, context);
  add_keys(app, context);
  add_model(app, context);
  add_replay(app, context);
  add_plan(app, context);

  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);
    std::fprintf(stderr, "biteline: %s (see --help)\n", error.what());
    return static_cast<int>(biteline::ExitStatus::BadInput);
  }
  try {
    const biteline::Result<biteline::ExitStatus> status = context.run();
    return status ? static_cast<int>(*status) : report_failure(status.error());
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr, "biteline: out of memory: raise the limit or free some, then start again\n");
    return static_cast<int>(biteline::ExitStatus::Connection);
  } catch (const std::exception& error) {
    // No exception is meant to arrive here; should one do so, the user still gets one line and no core dump.
    std::fprintf(stderr, "biteline: internal failure: %s\n", error.what());
    return static_cast<int>(biteline::ExitStatus::Connection);
  }
}
