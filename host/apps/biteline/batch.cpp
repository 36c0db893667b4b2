// SPDX-License-Identifier: MIT
// biteline batch: many recordings through one build, on this machine or many; and two builds compared.
#include <algorithm>
#include <memory>
#include <optional>
#include <thread>

#include "common/options/command.hpp"
#include "host/apps/biteline/batch_run.hpp"
#include "host/records/batch/plan.hpp"
#include "host/records/batch/recording.hpp"

namespace biteline::app {
namespace {

namespace fs = std::filesystem;

struct BatchOptions {
  fs::path manifest, folder, before, after;
  batch::BatchSettings settings;
  double shard_s{100};
  std::optional<std::size_t> shard;
  BatchRunOptions run;
  BatchMergeOptions merge;
};

Result<ExitStatus> plan_batch(const BatchOptions& options, const GlobalOptions& global) {
  report::Report report;
  BITELINE_ASSIGN(std::vector<batch::Recording> recordings, batch::find_recordings(options.manifest));
  const int processors = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  BITELINE_ASSIGN(const batch::BatchPlan plan, batch::make_plan({.recordings = std::move(recordings),
                                                                 .settings = options.settings,
                                                                 .shard_s = options.shard_s,
                                                                 .jobs = processors}));
  BITELINE_TRY(batch::write_plan(options.folder, plan));
  report.fields["recordings"] = plan.recordings.size();
  report.fields["shards"] = plan.shards.size();
  return tell(report, global,
              std::to_string(plan.recordings.size()) + " recordings in " +
                  std::to_string(plan.shards.size()) + (plan.shards.size() == 1 ? " shard" : " shards"));
}

Result<ExitStatus> run_planned(const BatchOptions& options, const GlobalOptions& global) {
  report::Report report;
  BITELINE_ASSIGN(const batch::BatchRun run, open_batch(options.folder, options.run));
  if (options.shard) {
    batch::RunCounts counts;
    BITELINE_TRY(batch::begin_run(run));
    BITELINE_TRY(batch::run_shard(run, *options.shard, counts));
    report.fields["computed"] = counts.computed;
    return tell(report, global, std::to_string(counts.computed) + " computed now");
  }
  BITELINE_TRY(run_batch(run, options.run, global, report));
  return tell(report, global, "");
}

Result<ExitStatus> merge_planned(const BatchOptions& options, const GlobalOptions& global) {
  report::Report report;
  BITELINE_ASSIGN(const batch::BatchRun run, open_batch(options.folder, options.run));
  return merge_batch(run, options.merge, global, report);
}

Result<ExitStatus> compare(const BatchOptions& options, const GlobalOptions& global) {
  report::Report report;
  BITELINE_ASSIGN(const batch::ResultSet before, batch::ResultSet::open(options.before));
  BITELINE_ASSIGN(const batch::ResultSet after, batch::ResultSet::open(options.after));
  return compare_batches(before, after, options.merge.out, options.merge.pictures, global, report);
}

}  // namespace

void add_batch(options::Command& app, Context& context) {
  auto options = std::make_shared<BatchOptions>();
  options::Command* command =
      app.add_subcommand("batch", "Many recordings through one build; two builds compared");
  command->require_subcommand(1);
  const auto add = [&](const char* name, const char* what, auto&& run) {
    options::Command* sub = command->add_subcommand(name, what);
    sub->callback([options, &context, run] {
      context.run = [options, &context, run] { return run(*options, context.options); };
    });
    return sub;
  };
  options::Command* plan = add("plan", "Hash the recordings and cut them into shards", plan_batch);
  plan->add_option("manifest", options->manifest,
                   "A text with a folder, session, cloud or pattern on each line; or one of these itself")
      ->required();
  plan->add_option("--out", options->folder, "The batch's folder; results are kept in it")->required();
  plan->add_option("--shard-s", options->shard_s, "What a shard takes at least, as estimated")
      ->capture_default_str()
      ->check(options::number({.minimum = 0, .maximum = 1e6}, "s"));
  plan->add_option("--unit", options->settings.unit, "Unit of the clouds")
      ->check(options::one_of({"mm", "m", "in"}).unshown())
      ->type_name("mm|m|in");
  plan->add_option("--method", options->settings.method, "How the line is found")
      ->capture_default_str()
      ->check(options::one_of({"default", "published"}).unshown())
      ->type_name("default|published");

  options::Command* run =
      add("run", "Compute what is not known yet of this build; a stopped run goes on", run_planned);
  run->add_option("folder", options->folder, "The batch's folder")->required();
  add_build_options(*run, options->run);
  add_limit_options(*run, options->run);
  add_engine_options(*run, options->run);
  run->add_option("--shard", options->shard, "This one alone: what a task of Slurm does");

  options::Command* merge = add("merge", "One SQLite file and one page of a finished run", merge_planned);
  merge->add_option("folder", options->folder, "The batch's folder")->required();
  add_build_options(*merge, options->run);
  add_merge_options(*merge, options->merge);

  options::Command* both =
      add("compare", "What changed from OLD to NEW; exit status 3 when something is worse", compare);
  both->add_option("old", options->before, "A merged folder, or a pinned baseline")->required();
  both->add_option("new", options->after, "A merged folder")->required();
  both->add_option("--out", options->merge.out, "Folder for index.html, report.json")->required();
  both->add_option("--pictures", options->merge.pictures, "Of so many changed lines")
      ->capture_default_str()
      ->check(options::whole_number(0, 1000));
}

}  // namespace biteline::app
