// SPDX-License-Identifier: MIT
#pragma once
/// \file What `batch run`, `batch merge` and `sweep` share: a run's options, doing it, and merging it.

#include <filesystem>
#include <optional>
#include <string>

#include "common/options/command.hpp"
#include "host/apps/biteline/command.hpp"
#include "host/records/batch/result_set.hpp"
#include "host/records/batch/run.hpp"
#include "host/records/batch/slurm.hpp"

namespace biteline::app {

struct BatchRunOptions {
  std::filesystem::path program, cell;  ///< empty: the sisters of this program
  std::string engine{"local"};
  int jobs{0};  ///< 0: one for each processor
  bool again{false};
  batch::ProcessLimits limits;
  batch::SlurmOptions slurm;
};
void add_build_options(options::Command& command, BatchRunOptions& options);
void add_limit_options(options::Command& command, BatchRunOptions& options);
void add_engine_options(options::Command& command, BatchRunOptions& options);

struct BatchMergeOptions {
  std::filesystem::path out, expect, pin;
  int pictures{10};
};
void add_merge_options(options::Command& command, BatchMergeOptions& options);

/// The plan in `folder` with the build and the limits.
[[nodiscard]] Result<batch::BatchRun> open_batch(const std::filesystem::path& folder,
                                                 const BatchRunOptions& options);

/// All shards that are missing; fills `report`.
[[nodiscard]] Result<void> run_batch(const batch::BatchRun& run, const BatchRunOptions& options,
                                     const GlobalOptions& global, report::Report& report);

/// SQLite file and page, then --pin and --expect; fills `report` and writes it into the folder.
[[nodiscard]] Result<ExitStatus> merge_batch(const batch::BatchRun& run, const BatchMergeOptions& options,
                                             const GlobalOptions& global, report::Report& report);

/// Compares, writes the page into `out` and refuses where something is worse.
[[nodiscard]] Result<ExitStatus> compare_batches(const batch::ResultSet& before,
                                                 const batch::ResultSet& after,
                                                 const std::filesystem::path& out, int pictures,
                                                 const GlobalOptions& global, report::Report& report);

}  // namespace biteline::app
