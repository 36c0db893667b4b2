// SPDX-License-Identifier: MIT
#pragma once
/// \file Runs a plan: every recording once for each build, and a file for each finished shard.

#include <cstddef>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "common/core/result.hpp"
#include "host/records/batch/plan.hpp"
#include "host/records/batch/store.hpp"
#include "host/records/batch/work.hpp"

namespace biteline::batch {

/// A batch folder: plan.json, store/, and runs/<id>/ for each build and settings, with shards/000000.json.
struct BatchRun {
  std::filesystem::path folder;
  BatchPlan plan;
  BatchBuild build;
  ProcessLimits limits;

  [[nodiscard]] std::string id() const;
  [[nodiscard]] std::filesystem::path run_folder() const { return folder / "runs" / id(); }
  [[nodiscard]] std::filesystem::path shard_file(std::size_t shard) const;
  [[nodiscard]] ResultStore store() const { return ResultStore{folder / "store"}; }
  [[nodiscard]] std::string key_of(const Recording& recording) const;
};

struct RunCounts {
  std::size_t computed{0};  ///< in this run; the others were known
  std::map<std::string, std::size_t> by_verdict;
  std::vector<std::string> without_answer;  ///< "NAME: verdict: reason", at most k_most_named
};
inline constexpr std::size_t k_most_named = 20;

/// Called from any thread, one call at a time.
using BatchProgress = std::function<void(std::size_t done)>;

/// Makes the run's folder, with run.json.
[[nodiscard]] Result<void> begin_run(const BatchRun& run);

/// Takes back what ended without an answer, so that the next run computes it anew.
[[nodiscard]] Result<void> forget_failures(const BatchRun& run);

/// Shards without a finished file of this run.
[[nodiscard]] std::vector<std::size_t> missing_shards(const BatchRun& run);

/// All missing shards on this machine, `jobs` recordings at a time.
[[nodiscard]] Result<void> run_local(const BatchRun& run, int jobs, const BatchProgress& progress,
                                     RunCounts& counts);

/// One shard, one recording after the other: what an array task does.
[[nodiscard]] Result<void> run_shard(const BatchRun& run, std::size_t shard, RunCounts& counts);

/// Verdicts of all finished shards.
[[nodiscard]] Result<void> count_verdicts(const BatchRun& run, RunCounts& counts);

}  // namespace biteline::batch
