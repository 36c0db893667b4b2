// SPDX-License-Identifier: MIT
#include "host/records/batch/run.hpp"

#include <atomic>
#include <cstdio>
#include <mutex>
#include <utility>

#include "host/records/batch/json_fields.hpp"
#include "host/records/batch/parallel.hpp"
#include "host/records/digest/digest.hpp"
#include "host/report/json_text.hpp"
#include "host/report/report.hpp"

namespace biteline::batch {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

/// The recording's outcome, from the store or computed now.
Result<Outcome> outcome_for(const BatchRun& run, const Recording& recording,
                            std::atomic<std::size_t>& computed) {
  const ResultStore store = run.store();
  const std::string key = run.key_of(recording);
  if (std::optional<Outcome> known = store.find(key)) return std::move(*known);
  BITELINE_ASSIGN(Worked worked, work_on(recording, run.plan.settings, run.build, run.limits));
  ++computed;
  // What is no longer the planned recording must not be filed under its hash.
  if (worked.outcome.verdict != "changed")
    BITELINE_TRY(store.put(key, worked.outcome, worked.line_csv, worked.cost));
  return std::move(worked.outcome);
}

Result<void> write_shard(const BatchRun& run, std::size_t shard, const std::vector<Outcome>& outcomes) {
  ordered_json results = ordered_json::array();
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    const Recording& recording = run.plan.recordings[run.plan.shards[shard][i]];
    ordered_json row{{"name", recording.name}, {"key", run.key_of(recording)}};
    row.update(to_json(outcomes[i]));
    results.push_back(std::move(row));
  }
  const ordered_json json{{"schema_version", 1},
                          {"build", run.build.identity},
                          {"settings", settings_text(run.plan.settings)},
                          {"results", std::move(results)}};
  return write_shared_file(run.shard_file(shard), report::to_text(json, 1) + "\n");
}

/// The keys say whether the file belongs to this plan: a plan may have been made anew in the same folder.
bool is_finished(const BatchRun& run, std::size_t shard) {
  const fs::path file = run.shard_file(shard);
  const Result<ordered_json> json = read_json_object(file);
  if (!json) return false;
  const auto results = JsonFields{*json, file}.array("results");
  const std::vector<std::size_t>& indices = run.plan.shards[shard];
  if (!results || (*results)->size() != indices.size()) return false;
  for (std::size_t i = 0; i < indices.size(); ++i) {
    const ordered_json& row = (**results)[i];
    const Result<Outcome> outcome = outcome_of(row, file);
    if (!outcome) return false;
    const JsonFields fields{row, file};
    const Recording& recording = run.plan.recordings[indices[i]];
    if (fields.text("key").value_or("") != run.key_of(recording)) return false;
    if (fields.text("name").value_or("") != recording.name) return false;
  }
  return true;
}

}  // namespace

std::string BatchRun::id() const {
  return Digest{}.add_text(build.identity).add_text(settings_text(plan.settings)).hex().substr(0, 16);
}

fs::path BatchRun::shard_file(std::size_t shard) const {
  char name[32];
  std::snprintf(name, sizeof name, "%06zu.json", shard);
  return run_folder() / "shards" / name;
}

std::string BatchRun::key_of(const Recording& recording) const {
  return result_key(recording.hash, build.identity, settings_text(plan.settings));
}

Result<void> begin_run(const BatchRun& run) {
  BITELINE_TRY(report::prepare_folder(run.run_folder() / "shards"));
  BITELINE_TRY(report::prepare_folder(run.folder / "store"));
  const ordered_json json{{"schema_version", 1},
                          {"build", run.build.identity},
                          {"settings", settings_text(run.plan.settings)},
                          {"program", run.build.program.string()}};
  return write_shared_file(run.run_folder() / "run.json", report::to_text(json) + "\n");
}

Result<void> forget_failures(const BatchRun& run) {
  for (std::size_t shard = 0; shard < run.plan.shards.size(); ++shard) {
    const fs::path file = run.shard_file(shard);
    const Result<ordered_json> json = read_json_object(file);
    if (!json) continue;
    BITELINE_ASSIGN(const ordered_json* const results, (JsonFields{*json, file}.array("results")));
    bool failed = false;
    for (const ordered_json& row : *results) {
      const JsonFields fields{row, file};
      if (is_answer(fields.text("verdict").value_or(""))) continue;
      failed = true;
      BITELINE_ASSIGN(const std::string key, fields.text("key"));
      BITELINE_TRY(run.store().forget(key));
    }
    std::error_code error;
    if (failed && !fs::remove(file, error))
      return fail_errno(Errc::WriteFailed, error.value(), "%s", file.c_str());
  }
  return {};
}

std::vector<std::size_t> missing_shards(const BatchRun& run) {
  std::vector<std::size_t> missing;
  for (std::size_t shard = 0; shard < run.plan.shards.size(); ++shard) {
    if (!is_finished(run, shard)) missing.push_back(shard);
  }
  return missing;
}

Result<void> run_local(const BatchRun& run, int jobs, const BatchProgress& progress, RunCounts& counts) {
  struct Place {
    std::size_t shard, row;
  };
  const std::vector<std::size_t> missing = missing_shards(run);
  std::vector<Place> places;
  std::vector<std::vector<Outcome>> outcomes(run.plan.shards.size());
  std::vector<std::size_t> left(run.plan.shards.size());
  for (const std::size_t shard : missing) {
    left[shard] = run.plan.shards[shard].size();
    outcomes[shard].resize(left[shard]);
    for (std::size_t row = 0; row < left[shard]; ++row) places.push_back({shard, row});
  }
  std::atomic<std::size_t> computed{0};
  std::mutex mutex;
  std::size_t done = run.plan.recordings.size() - places.size();
  const Result<void> ran = for_each_index(places.size(), jobs, [&](std::size_t i) -> Result<void> {
    const auto [shard, row] = places[i];
    BITELINE_ASSIGN(Outcome outcome,
                    outcome_for(run, run.plan.recordings[run.plan.shards[shard][row]], computed));
    const std::lock_guard lock{mutex};
    outcomes[shard][row] = std::move(outcome);
    if (progress) progress(++done);
    if (--left[shard] > 0) return {};
    return write_shard(run, shard, std::exchange(outcomes[shard], {}));
  });
  counts.computed += computed;
  return ran;
}

Result<void> run_shard(const BatchRun& run, std::size_t shard, RunCounts& counts) {
  if (shard >= run.plan.shards.size()) {
    return fail(Errc::InvalidArgument, "--shard %zu: the plan has %zu, from 0 on", shard,
                run.plan.shards.size());
  }
  if (is_finished(run, shard)) return {};
  std::atomic<std::size_t> computed{0};
  std::vector<Outcome> outcomes;
  for (const std::size_t index : run.plan.shards[shard]) {
    BITELINE_ASSIGN(Outcome outcome, outcome_for(run, run.plan.recordings[index], computed));
    outcomes.push_back(std::move(outcome));
  }
  counts.computed += computed;
  return write_shard(run, shard, outcomes);
}

Result<void> count_verdicts(const BatchRun& run, RunCounts& counts) {
  for (std::size_t shard = 0; shard < run.plan.shards.size(); ++shard) {
    const fs::path file = run.shard_file(shard);
    std::error_code ignored;
    if (!fs::exists(file, ignored)) continue;
    BITELINE_ASSIGN(const ordered_json json, read_json_object(file));
    BITELINE_ASSIGN(const ordered_json* const results, (JsonFields{json, file}.array("results")));
    for (const ordered_json& row : *results) {
      BITELINE_ASSIGN(const Outcome outcome, outcome_of(row, file));
      ++counts.by_verdict[outcome.verdict];
      if (is_answer(outcome.verdict) || counts.without_answer.size() >= k_most_named) continue;
      counts.without_answer.push_back((JsonFields{row, file}.text("name").value_or("")) + ": " +
                                      outcome.verdict + ": " + outcome.reason);
    }
  }
  return {};
}

}  // namespace biteline::batch
