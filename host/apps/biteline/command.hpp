// SPDX-License-Identifier: MIT
#pragma once
/// \file How a subcommand of `biteline` hooks in: one file, one add_<command>() each.

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "common/core/result.hpp"
#include "common/options/command.hpp"
#include "host/report/report.hpp"

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

/// As tell(), for a command that wrote `folder` with its index.html: the page to open and what to do next, on
/// stdout: a refusal stays one line on stderr. `told` is why there is no sure result; its own next step is
/// told then, and `next` otherwise.
[[nodiscard]] ExitStatus tell_folder(report::Report& report, const GlobalOptions& global,
                                     const std::string& words, const std::filesystem::path& folder,
                                     const std::optional<report::ToldRefusal>& told, const std::string& next);

/// The next step after a line was found into `folder`: a path along it.
[[nodiscard]] std::string plan_step(const std::filesystem::path& folder);

void add_batch(options::Command& app, Context& context);
void add_calibrate(options::Command& app, Context& context);
void add_capture(options::Command& app, Context& context);
void add_demo(options::Command& app, Context& context);
void add_doctor(options::Command& app, Context& context);
void add_evaluate(options::Command& app, Context& context);
void add_explain(options::Command& app, Context& context);
void add_extract(options::Command& app, Context& context);
void add_flow_test(options::Command& app, Context& context);
void add_history(options::Command& app, Context& context);
void add_inspect(options::Command& app, Context& context);
void add_keys(options::Command& app, Context& context);
void add_laser_class(options::Command& app, Context& context);
void add_line(options::Command& app, Context& context);
void add_model(options::Command& app, Context& context);
void add_mounted(options::Command& app, Context& context);
void add_plan(options::Command& app, Context& context);
void add_record(options::Command& app, Context& context);
void add_replay(options::Command& app, Context& context);
void add_rework(options::Command& app, Context& context);
void add_settings(options::Command& app, Context& context);
void add_study(options::Command& app, Context& context);
void add_sweep(options::Command& app, Context& context);
void add_target(options::Command& app, Context& context);
void add_transfer(options::Command& app, Context& context);
void add_work_force(options::Command& app, Context& context);
void add_work_quality(options::Command& app, Context& context);

}  // namespace biteline::app
