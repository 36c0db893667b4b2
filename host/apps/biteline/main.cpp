// SPDX-License-Identifier: MIT
// The tool: one subcommand for each thing that a person does with scans, lines and heads.
#include <algorithm>
#include <cstdio>
#include <exception>
#include <new>
#include <numeric>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/system/last_words.hpp"
#include "host/apps/biteline/command.hpp"

namespace {

using biteline::options::Command;

int report_failure(const biteline::Error& error) {
  std::fprintf(stderr, "biteline: %s\n", biteline::to_line(error).c_str());
  return static_cast<int>(biteline::error_row(error.code).exit_status);
}

/// How many letters must be put in, left out or changed to make `a` of `b`.
std::size_t difference(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t changed = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({changed, row[j] + 1, row[j - 1] + 1});
    }
  }
  return row.back();
}

constexpr std::size_t k_longest_name = 40, k_most_letters_wrong = 2;

/// The nearest of `names` that may have been meant; empty: none is near.
std::string nearest_of(std::string_view word, const std::vector<std::string>& names) {
  std::string nearest;
  std::size_t least = k_most_letters_wrong + 1;
  for (const std::string& name : names) {
    const std::size_t wrong = difference(word, name);
    if (wrong >= least) continue;
    least = wrong;
    nearest = name;
  }
  return nearest;
}

/// The first word, where it is no command, and the command it may have been meant for.
std::optional<std::string> mistyped_command(const Command& app, int argc, char** argv) {
  int i = 1;
  while (i < argc && argv[i][0] == '-') ++i;
  if (i == argc) return std::nullopt;
  const std::string_view word = std::string_view{argv[i]}.substr(0, k_longest_name);
  std::vector<std::string> names;
  std::string all;
  for (const Command& command : app.commands()) {
    if (command.name() == word) return std::nullopt;
    names.push_back(command.name());
    all += (all.empty() ? "" : ", ") + command.name();
  }
  const std::string nearest = nearest_of(word, names);
  return "no command '" + std::string{word} + "'" +
         (nearest.empty() ? "; there are " + all : "; did you mean " + nearest + "?");
}

/// The first option that no command on the way knows, and the one it may have been meant for.  A value that
/// begins with two dashes is taken for one, too: it is asked for only where the line was refused.
std::optional<std::string> mistyped_option(const Command& app, int argc, char** argv) {
  std::vector<std::string> names;
  const auto learn = [&names](const Command& of) {
    for (const std::string& name : of.long_names()) names.push_back("--" + name);
  };
  learn(app);
  const Command* command = &app;
  for (int i = 1; i < argc; ++i) {
    const std::string word{argv[i]};
    if (word.starts_with("--")) continue;
    for (const Command& next : command->commands()) {
      if (next.name() != word) continue;
      command = &next;
      learn(next);
      break;
    }
  }
  for (int i = 1; i < argc; ++i) {
    const std::string word = std::string{argv[i]}.substr(0, std::string_view{argv[i]}.find('='));
    if (word.size() <= 2 || word.size() > k_longest_name || !word.starts_with("--")) continue;
    if (std::ranges::find(names, word) != names.end()) continue;
    const std::string nearest = nearest_of(word, names);
    if (!nearest.empty()) return "no option '" + word + "'; did you mean " + nearest + "?";
  }
  return std::nullopt;
}

/// `biteline help [COMMAND]...` is `biteline [COMMAND]... --help`.
std::vector<std::string> words_of(int argc, char** argv) {
  std::vector<std::string> words(argv + 1, argv + argc);
  if (words.empty() || words.front() != "help") return words;
  words.erase(words.begin());
  words.emplace_back("--help");
  return words;
}

}  // namespace

namespace biteline::app {

ExitStatus tell(report::Report& report, const GlobalOptions& global, const std::string& words) {
  if (global.json) {
    std::fputs(report.text().c_str(), stdout);
  } else if (!words.empty() && !global.quiet) {
    std::fprintf(report.refused() ? stderr : stdout, "%s\n", words.c_str());
  }
  return report.status();
}

ExitStatus tell_folder(report::Report& report, const GlobalOptions& global, const std::string& words,
                       const std::filesystem::path& folder, const std::optional<report::ToldRefusal>& told,
                       const std::string& next) {
  const ExitStatus status = tell(report, global, words);
  if (global.json || global.quiet) return status;
  std::printf("  page: %s\n", (folder / "index.html").c_str());
  const std::string& step = told ? told->next_step : next;
  if (!step.empty()) std::printf("  next: %s\n", step.c_str());
  return status;
}

std::string plan_step(const std::filesystem::path& folder) {
  return "biteline plan " + (folder / "line.csv").string() + " --robot NAME --process FILE --out DIR";
}

}  // namespace biteline::app

int main(int argc, char** argv) {
  biteline::install_last_words("biteline");
  using namespace biteline::app;
  biteline::options::Command app{
      "Biteline: finds a shoe's bite line in laser scans and plans a tool path along it.", "biteline"};
  Context context;
  app.require_subcommand(1);
  app.fallthrough();
  app.add_flag("--quiet", context.options.quiet, "No progress, no words beyond the result");
  app.add_flag("--json", context.options.json, "The result's report.json on stdout, and nothing else");
  app.set_version_flag("-V,--version", "biteline " BITELINE_VERSION);
  // In the order of the work, as --help tells them: a cell made ready, a scan, its line, its path, the books.
  add_doctor(app, context);
  add_demo(app, context);
  add_laser_class(app, context);
  add_target(app, context);
  add_capture(app, context);
  add_calibrate(app, context);
  add_mounted(app, context);
  add_flow_test(app, context);
  add_keys(app, context);
  add_settings(app, context);
  add_record(app, context);
  add_replay(app, context);
  add_extract(app, context);
  add_inspect(app, context);
  add_explain(app, context);
  add_line(app, context);
  add_model(app, context);
  add_transfer(app, context);
  add_plan(app, context);
  add_rework(app, context);
  add_history(app, context);
  add_work_force(app, context);
  add_work_quality(app, context);
  add_study(app, context);
  add_evaluate(app, context);
  add_batch(app, context);
  add_sweep(app, context);

  if (const std::optional<biteline::options::Leave> leave = app.parse(words_of(argc, argv))) {
    if (leave->fault.empty()) return 0;
    std::optional<std::string> what = mistyped_command(app, argc, argv);
    if (!what) what = mistyped_option(app, argc, argv);
    std::fprintf(stderr, "biteline: %s (see --help)\n", what.value_or(leave->fault).c_str());
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
