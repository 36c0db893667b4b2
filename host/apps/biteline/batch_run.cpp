// SPDX-License-Identifier: MIT
#include "host/apps/biteline/batch_run.hpp"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdio>
#include <memory>
#include <thread>

#include "common/options/command.hpp"
#include "host/records/batch/compare.hpp"
#include "host/records/batch/merge.hpp"
#include "host/report/file_lock.hpp"
#include "host/report/progress.hpp"

namespace biteline::app {
namespace {

namespace fs = std::filesystem;

volatile std::sig_atomic_t g_stop = 0;

/// Ctrl-C lets a run on Slurm cancel its job.
void hear_signals() {
  struct sigaction action {};
  action.sa_handler = [](int) { g_stop = 1; };
  ::sigaction(SIGINT, &action, nullptr);
  ::sigaction(SIGTERM, &action, nullptr);
}

fs::path sister(const char* name) {
  std::error_code ignored;
  return fs::read_symlink("/proc/self/exe", ignored).parent_path() / name;
}

std::string words_of(const batch::RunCounts& counts, std::size_t recordings) {
  std::string words =
      std::to_string(recordings) + " recordings, " + std::to_string(counts.computed) + " computed now";
  for (const auto& [verdict, count] : counts.by_verdict)
    words += ", " + std::to_string(count) + " " + verdict;
  for (const std::string& name : counts.without_answer) words += "\n" + name;
  return words;
}

void fill(report::Report& report, const batch::Comparison& comparison) {
  using enum batch::Judgement;
  auto& differences = report.fields["differences"] = nlohmann::ordered_json::array();
  constexpr std::array k_words{"better", "same", "worse"};
  for (const batch::Difference& difference : comparison.differences) {
    differences.push_back({{"name", difference.name},
                           {"judged", k_words.at(static_cast<std::size_t>(difference.judgement))},
                           {"what", difference.what},
                           {"moved_mm", difference.moved_mm}});
  }
  report.fields["compared"] = comparison.compared;
  report.fields["added"] = comparison.added;
  report.fields["better"] = comparison.count(Better);
  report.fields["worse"] = comparison.count(Worse);
}

}  // namespace

void add_build_options(options::Command& command, BatchRunOptions& options) {
  command.add_option("--program", options.program, "The biteline that is judged; without: this one");
  command.add_option("--cell", options.cell,
                     "The biteline-cell that makes recordings; without: beside this one");
}

void add_limit_options(options::Command& command, BatchRunOptions& options) {
  command.add_option("--time-s", options.limits.time_s, "A recording that takes longer is killed and named")
      ->capture_default_str()
      ->check(options::number({.minimum = 0.1, .maximum = 86400}, "s"));
  command.add_option("--memory-mb", options.limits.memory_mb, "Memory of a recording's process")
      ->capture_default_str()
      ->check(options::number({.minimum = 16, .maximum = 1e6}, "MB"));
}

void add_engine_options(options::Command& command, BatchRunOptions& options) {
  command.add_option("--engine", options.engine, "Processes of this machine, or array jobs of Slurm")
      ->capture_default_str()
      ->check(options::one_of({"local", "slurm"}).unshown())
      ->type_name("local|slurm");
  command.add_option("--jobs", options.jobs, "At a time; 0: one for each processor, on Slurm as many as fit")
      ->capture_default_str()
      ->check(options::whole_number(0, 10000));
  command.add_flag("--again", options.again, "Compute anew what crashed, hung or failed before");
  command.add_option("--partition", options.slurm.partition, "Slurm's partition; without: its own choice");
  command
      .add_option("--attempts", options.slurm.attempts, "How often Slurm gets a shard that left no result")
      ->capture_default_str()
      ->check(options::whole_number(1, 100));
  command.add_option("--look-every-s", options.slurm.look_every_s, "Between two looks at Slurm's queue")
      ->capture_default_str()
      ->check(options::number({.minimum = 0.1, .maximum = 3600}, "s"));
}

void add_merge_options(options::Command& command, BatchMergeOptions& options) {
  command.add_option("--out", options.out, "Folder for batch.sqlite, index.html, report.json")->required();
  command.add_option("--expect", options.expect, "A pinned baseline: exit status 3 when something is worse");
  command.add_option("--pin", options.pin, "Write these results as a baseline (.json) for version control");
  command.add_option("--pictures", options.pictures, "Of so many lines on the page")
      ->capture_default_str()
      ->check(options::whole_number(0, 1000));
}

Result<batch::BatchRun> open_batch(const fs::path& folder, const BatchRunOptions& options) {
  batch::BatchRun run;
  std::error_code error;
  run.folder = fs::absolute(folder, error);
  BITELINE_ASSIGN(run.plan, batch::read_plan(run.folder));
  BITELINE_ASSIGN(run.build, batch::build_of(options.program.empty() ? sister("biteline") : options.program,
                                             options.cell.empty() ? sister("biteline-cell") : options.cell));
  run.limits = options.limits;
  return run;
}

Result<void> run_batch(const batch::BatchRun& run, const BatchRunOptions& options,
                       const GlobalOptions& global, report::Report& report) {
  BITELINE_TRY(batch::begin_run(run));
  BITELINE_ASSIGN(const report::FileLock lock,
                  report::FileLock::take(run.run_folder() / "run.lock",
                                         "biteline batch run, process " + std::to_string(::getpid())));
  if (options.again) BITELINE_TRY(batch::forget_failures(run));
  batch::RunCounts counts;
  report::Progress progress{"recordings", run.plan.recordings.size(), global.quiet};
  const auto show = [&](std::size_t done) { progress.set(done); };
  if (options.engine == "slurm") {
    hear_signals();
    batch::SlurmOptions slurm = options.slurm;
    slurm.at_a_time = options.jobs;
    BITELINE_TRY(batch::run_slurm(run, slurm, show, &g_stop));
  } else {
    const int processors = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
    BITELINE_TRY(batch::run_local(run, options.jobs > 0 ? options.jobs : processors, show, counts));
  }
  BITELINE_TRY(batch::count_verdicts(run, counts));
  report.fields["run"] = run.id();
  report.fields["build"] = run.build.identity;
  report.fields["recordings"] = run.plan.recordings.size();
  if (options.engine == "local") report.fields["computed"] = counts.computed;
  report.fields["verdicts"] = counts.by_verdict;
  report.fields["without_answer"] = counts.without_answer;
  if (!global.json && !global.quiet)
    std::fprintf(stdout, "%s\n", words_of(counts, run.plan.recordings.size()).c_str());
  return {};
}

Result<ExitStatus> merge_batch(const batch::BatchRun& run, const BatchMergeOptions& options,
                               const GlobalOptions& global, report::Report& report) {
  BITELINE_ASSIGN(const batch::ResultSet results, batch::merge_run(run, options.out));
  BITELINE_TRY(batch::write_results_page(results, run.plan, options.out, options.pictures));
  report.fields["run"] = run.id();
  report.fields["build"] = run.build.identity;
  report.fields["recordings"] = results.rows().size();
  if (!options.pin.empty()) BITELINE_TRY(batch::write_baseline(options.pin, results));
  if (!options.expect.empty()) {
    BITELINE_ASSIGN(const batch::ResultSet expected, batch::ResultSet::open(options.expect));
    return compare_batches(expected, results, options.out / "expected", options.pictures, global, report);
  }
  BITELINE_TRY(report.write(options.out));
  return tell(report, global, (options.out / "index.html").string());
}

Result<ExitStatus> compare_batches(const batch::ResultSet& before, const batch::ResultSet& after,
                                   const fs::path& out, int pictures, const GlobalOptions& global,
                                   report::Report& report) {
  BITELINE_ASSIGN(const batch::Comparison comparison, batch::compare_runs(before, after));
  BITELINE_TRY(batch::write_comparison_page(comparison, before, after, out, pictures));
  fill(report, comparison);
  std::string words = std::to_string(comparison.compared) +
                      " recordings compared: " + std::to_string(comparison.count(batch::Judgement::Better)) +
                      " better, " + std::to_string(comparison.count(batch::Judgement::Worse)) + " worse";
  if (const auto refusal = batch::refusal_of(comparison)) {
    report.refuse(*refusal);
    words = "biteline: " + refusal->reason;
  }
  BITELINE_TRY(report.write(out));
  return tell(report, global, words);
}

}  // namespace biteline::app
