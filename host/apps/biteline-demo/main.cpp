// SPDX-License-Identifier: MIT
// biteline-demo: a sample and the uppers after it through the simulated cell, by the real sensor program and
// host service.  A program of its own, so that a first demo builds no more than it needs.
#include <atomic>
#include <csignal>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "common/options/command.hpp"
#include "common/system/last_words.hpp"
#include "common/system/own_network.hpp"
#include "host/apps/biteline-demo/cell_run.hpp"
#include "host/apps/biteline-demo/demo_page.hpp"
#include "host/apps/biteline-demo/live_cell.hpp"
#include "host/intake/child_process.hpp"
#include "host/report/report.hpp"

namespace biteline::demo {
namespace {

namespace fs = std::filesystem;

struct Options {
  CellOptions cell;
  int uppers{2};
  bool json{false};
  bool web{false};  ///< the cell with its page, until somebody ends it
  std::string web_address;
};

std::atomic<bool> g_stop{false};
static_assert(std::atomic<bool>::is_always_lock_free, "set in a signal handler");

void heed_stop_signals() {
  struct sigaction action {};
  action.sa_handler = [](int) { g_stop = true; };
  sigaction(SIGTERM, &action, nullptr);
  sigaction(SIGINT, &action, nullptr);
}

/// The processes' files stand beside the programs, as built and as installed.
fs::path process_file(const std::string& name) {
  return intake::program_folder().parent_path() / "share" / "biteline" / "processes" / (name + ".yaml");
}

/// The sample, then the uppers that take its line over; nothing after a sample without a line.
Result<std::vector<ShoeResult>> run_shoes(const Options& options, const CellOptions& cell) {
  std::vector<ShoeResult> results;
  const auto run = [&](const Shoe& shoe, const char* what) -> Result<void> {
    if (!cell.quiet) std::printf("%s: %s\n", shoe.name.c_str(), what), std::fflush(stdout);
    BITELINE_ASSIGN(ShoeResult result, run_shoe(cell, shoe));
    if (!cell.quiet) std::printf("  %s\n", result.verdict.c_str());
    if (!cell.quiet && result.made) std::printf("  %s\n", words(*result.made).c_str());
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

nlohmann::ordered_json shoe_fields(const ShoeResult& result) {
  nlohmann::ordered_json fields{{"name", result.shoe.name},        {"scan", result.scan.string()},
                                {"verdict", result.verdict},       {"scan_s", result.scan_s},
                                {"time_ratio", result.time_ratio}, {"total_s", result.wall_s}};
  if (const auto& made = result.made) {
    fields["made_s"] = {{"scan", made->scan_s},           {"rest", made->rest_s},
                        {"sets_out", made->sets_out_s},   {"line_and_path", made->line_and_path_s},
                        {"way_there", made->way_there_s}, {"approach", made->approach_s},
                        {"work", made->work_s},           {"retreat", made->retreat_s},
                        {"whole", made->whole_s()}};
  }
  if (result.error) {
    fields["line_error_mm"] = {
        {"mean", result.error->mean_mm}, {"p95", result.error->p95_mm}, {"max", result.error->max_mm}};
  }
  return fields;
}

Result<ExitStatus> run_demo(const Options& options) {
  if (options.web) {
    // Only here: without the page a signal ends this program at once, and the others with it.
    heed_stop_signals();
    return run_live({.cell = options.cell, .address = options.web_address}, g_stop);
  }
  CellOptions cell = options.cell;
  cell.quiet = cell.quiet || options.json;
  // Several beside each other: the camera's port is fixed.  Where the kernel gives none, one at a time.
  if (const Result<void> own = enter_own_network(); !own && !cell.quiet)
    std::printf("one cell at a time on this machine: %s\n", to_line(own.error()).c_str());
  report::Report report;
  BITELINE_TRY(report::prepare_folder(cell.out));
  BITELINE_ASSIGN(const std::vector<ShoeResult> results,
                  report.timed("shoes", [&] { return run_shoes(options, cell); }));
  const ExitStatus status = status_of(results);
  std::string verdict;
  for (const ShoeResult& result : results)
    verdict += (verdict.empty() ? "" : "; ") + result.shoe.name + ": " + result.verdict;
  BITELINE_TRY(write_demo_page(cell, results, verdict, status == ExitStatus::Done));
  report.fields["simulated"] = true;
  for (const ShoeResult& result : results) report.fields["shoes"].push_back(shoe_fields(result));
  if (status != ExitStatus::Done) report.refuse(verdict);
  BITELINE_TRY(report.write(cell.out));
  if (options.json) std::fputs(report.text().c_str(), stdout);
  if (!cell.quiet) std::printf("open %s\n", (cell.out / "index.html").c_str());
  return status;
}

void add_options(options::Command& app, Options& options) {
  options.cell.process = process_file("grind");
  app.set_version_flag("--version", "biteline-demo " BITELINE_VERSION);
  app.add_flag("--quiet", options.cell.quiet, "No progress, no words beyond the result");
  auto* json = app.add_flag("--json", options.json, "The demo's report.json on stdout, and nothing else");
  app.add_option("--out", options.cell.out, "Result folder")->capture_default_str();
  app.add_option("--seed", options.cell.seed, "Which made shoe")->capture_default_str();
  app.add_option("--shoe", options.cell.shoe, "Class of made shoe (biteline-cell serve --help)")
      ->capture_default_str();
  app.add_option("--size", options.cell.size,
                 "European size, 36 to 47 for grown-ups; 0: as long as the class draws it, a child's too")
      ->check(options::one_of_numbers({0.0}) | options::number({.minimum = 14, .maximum = 52}, ""))
      ->capture_default_str();
  app.add_option("--speed-mm-s", options.cell.speed_mm_s,
                 "Of the stripe along the outline; the arm goes slower where its joints ask for it")
      ->check(options::number({.minimum = 1, .maximum = 1000}, ""))
      ->capture_default_str();
  app.add_option("--scan-begin", options.cell.scan_begin_ratio,
                 "Where on the way round the scan begins and ends, anticlockwise from the heel; 0.25: in the "
                 "waist, where the wrist is slow")
      ->check(options::number({.minimum = 0, .maximum = 1}, ""))
      ->capture_default_str();
  app.add_flag("--scan-clockwise,!--scan-anticlockwise", options.cell.scan_clockwise,
               "Which way round the arm takes the head, as seen from above (default: clockwise, so that the "
               "path turns the wrist back)");
  app.add_option("--rate-hz", options.cell.rate_hz, "Pictures a second")
      ->check(options::number({.minimum = 1, .maximum = 1000}, ""))
      ->capture_default_str();
  app.add_option(
         "--time-ratio", options.cell.time_ratio,
         "Scans go at this share of real time, arm and trigger together (default: as much of it as this "
         "machine can)")
      ->check(options::number({.minimum = 0.05, .maximum = 1}, ""));
  auto* uppers = app.add_option("--uppers", options.uppers, "How many uppers follow the sample")
                     ->check(options::number({.minimum = 0, .maximum = 20}, ""))
                     ->capture_default_str();
  app.add_option(
         "--web", options.web_address,
         "Open the cell's page in place of all that: one shoe, scan after scan, until Ctrl-C; ADDRESS or "
         "ADDRESS:PORT: where the page listens")
      ->expected(0, 1)
      ->excludes(json)
      ->excludes(uppers);
  app.add_option("--arm", options.cell.arm, "ur3e, ur5e or ur10e")->capture_default_str();
  app.add_option("--world", options.cell.world,
                 "real: elastic joints, following error, latency, blur, speckle, table, fixture and lamps; "
                 "ideal: none of these")
      ->check(options::one_of({"ideal", "real"}))
      ->capture_default_str();
  app.add_option("--process", options.cell.process, "Process YAML; default: grind");
}

}  // namespace
}  // namespace biteline::demo

int main(int argc, char** argv) {
  biteline::install_last_words("biteline-demo");
  biteline::options::Command app{
      "The main job without hardware: a sample and the uppers after it; simulated cell, real sensor program "
      "and "
      "host service.",
      "biteline-demo"};
  biteline::demo::Options options;
  biteline::demo::add_options(app, options);
  if (const std::optional<biteline::options::Leave> leave = app.parse(argc, argv)) {
    if (leave->fault.empty()) return 0;
    std::fprintf(stderr, "biteline-demo: %s (see --help)\n", leave->fault.c_str());
    return static_cast<int>(biteline::ExitStatus::BadInput);
  }
  options.web = app.get_option("--web")->count() > 0;
  const biteline::Result<biteline::ExitStatus> status = biteline::demo::run_demo(options);
  if (status) return static_cast<int>(*status);
  std::fprintf(stderr, "biteline-demo: %s\n", biteline::to_line(status.error()).c_str());
  return static_cast<int>(biteline::error_row(status.error().code).exit_status);
}
