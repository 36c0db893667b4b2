// SPDX-License-Identifier: MIT
#pragma once
/// \file How a subcommand of `biteline` hooks in: one file, one add_<command>() each.

#include <CLI/CLI.hpp>
#include <functional>
#include <string>

#include "common/core/result.hpp"
#include "host/records/report/report.hpp"

namespace biteline::app {

/// --quiet and --json, valid for every subcommand.
struct GlobalOptions {
  bool quiet{false};
  bool json{false};
};

/// What main() runs after parsing: the chosen subcommand sets it from its callback.  An Error becomes one
/// line on stderr and its row's exit status.
struct Context {
  GlobalOptions options;
  std::function<Result<ExitStatus>()> run;
};

/// A command's last words.  With --json exactly report.json on stdout, whatever the verdict; else `words` for
/// a person, on stderr when refused.  Call after the report was written.
[[nodiscard]] ExitStatus tell(report::Report& report, const GlobalOptions& global, const std::string& words);

void add_batch(CLI::App& app, Context& context);
void add_calibrate(CLI::App& app, Context& context);
void add_capture(CLI::App& app, Context& context);
void add_demo(CLI::App& app, Context& context);
void add_doctor(CLI::App& app, Context& context);
void add_evaluate(CLI::App& app, Context& context);
void add_explain(CLI::App& app, Context& context);
void add_extract(CLI::App& app, Context& context);
void add_history(CLI::App& app, Context& context);
void add_keys(CLI::App& app, Context& context);
void add_line(CLI::App& app, Context& context);
void add_model(CLI::App& app, Context& context);
void add_mounted(CLI::App& app, Context& context);
void add_plan(CLI::App& app, Context& context);
void add_record(CLI::App& app, Context& context);
void add_replay(CLI::App& app, Context& context);
void add_settings(CLI::App& app, Context& context);
void add_sweep(CLI::App& app, Context& context);
void add_target(CLI::App& app, Context& context);
void add_transfer(CLI::App& app, Context& context);

}  // namespace biteline::app
