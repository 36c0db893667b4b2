// SPDX-License-Identifier: MIT
// biteline demo: a sample and the uppers after it through the simulated cell, by the real sensor program and
// host service.
#include <cstdio>

#include "common/options/number.hpp"
#include "host/apps/biteline/command.hpp"
#include "host/apps/biteline/demo/cell_run.hpp"
#include "host/apps/biteline/demo/demo_page.hpp"
#include "host/intake/child_process.hpp"
#include "host/report/report.hpp"

namespace biteline::app {
namespace {

namespace fs = std::filesystem;
using demo::CellOptions;
using demo::Shoe;
using demo::ShoeResult;

struct Options {
  CellOptions cell;
  int uppers{2};
};

/// The processes' files stand beside the programs, as built and as installed.
fs::path process_file(const std::string& name) {
  return intake::program_folder().parent_path() / "share" / "biteline" / "processes" / (name + ".yaml");
}

/// The sample, then the uppers that take its line over; nothing after a sample without a line.
Result<std::vector<ShoeResult>> run_shoes(const Options& options, const CellOptions& cell) {
  std::vector<ShoeResult> results;
  const auto run = [&](const Shoe& shoe, const char* what) -> Result<void> {
    if (!cell.quiet) std::printf("%s: %s\n", shoe.name.c_str(), what), std::fflush(stdout);
    BITELINE_ASSIGN(ShoeResult result, demo::run_shoe(cell, shoe));
    if (!cell.quiet) std::printf("  %s\n", result.verdict.c_str());
    results.push_back(std::move(result));
    return {};
  };
  BITELINE_TRY(run({.name = "sample"}, "scanned with its sole, its line found, planned, followed"));
  if (!results.front().error) return results;
  const fs::path sample = results.front().scan;
  for (int i = 1; i <= options.uppers; ++i) {
    const Shoe upper{.name = "upper-" + std::to_string(i),
                     .place = cell.seed + static_cast<std::uint64_t>(i),
                     .sample = sample};
    BITELINE_TRY(run(upper, "without a sole, in another place: aligned with the sample, planned, followed"));
  }
  return results;
}

ExitStatus status_of(const std::vector<ShoeResult>& results) {
  for (const ShoeResult& result : results) {
    if (result.good()) continue;
    return result.host_status == static_cast<int>(ExitStatus::Refused) ? ExitStatus::Refused
                                                                       : ExitStatus::Connection;
  }
  return ExitStatus::Done;
}

Result<ExitStatus> run_demo(const Options& options, const GlobalOptions& global) {
  CellOptions cell = options.cell;
  cell.quiet = global.quiet;
  BITELINE_TRY(report::prepare_folder(cell.out));
  BITELINE_ASSIGN(const std::vector<ShoeResult> results, run_shoes(options, cell));
  const ExitStatus status = status_of(results);
  std::string verdict;
  for (const ShoeResult& result : results)
    verdict += (verdict.empty() ? "" : "; ") + result.shoe.name + ": " + result.verdict;
  BITELINE_TRY(demo::write_demo_page(cell, results, verdict, status == ExitStatus::Done));
  if (!cell.quiet) std::printf("open %s\n", (cell.out / "index.html").c_str());
  return status;
}

}  // namespace

void add_demo(CLI::App& app, Context& context) {
  auto options = std::make_shared<Options>();
  options->cell.process = process_file("grind");
  CLI::App* command = app.add_subcommand("demo",
                                         "The main job without hardware: a sample and the uppers after it; "
                                         "simulated cell, real sensor program and host service");
  command->add_option("--out", options->cell.out, "Result folder")->capture_default_str();
  command->add_option("--seed", options->cell.seed, "Which made shoe")->capture_default_str();
  command->add_option("--shoe", options->cell.shoe, "Class of made shoe (biteline-cell serve --help)")
      ->capture_default_str();
  command->add_option("--uppers", options->uppers, "How many uppers follow the sample")
      ->check(options::number({.minimum = 0, .maximum = 20}, ""))
      ->capture_default_str();
  command->add_option("--arm", options->cell.arm, "ur3e, ur5e or ur10e")->capture_default_str();
  command->add_option("--process", options->cell.process, "Process YAML; default: grind");
  command->callback([options, &context] {
    context.run = [options, &context] { return run_demo(*options, context.options); };
  });
}

}  // namespace biteline::app
