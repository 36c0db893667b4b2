// SPDX-License-Identifier: MIT
#pragma once
/// \file A run on many machines: array jobs of Slurm, by its commands alone.

#include <csignal>
#include <string>

#include "common/core/result.hpp"
#include "host/records/batch/run.hpp"

namespace biteline::batch {

struct SlurmOptions {
  std::string partition;    ///< empty: the cluster's own
  int at_a_time{0};         ///< array tasks at most; 0: as many as there is room for
  int attempts{3};          ///< how often a shard that left no file is submitted
  double look_every_s{10};  ///< between two looks at the queue
};

/// Submits the missing shards and waits until no task is left in the queue.  Whether a shard is done is told
/// by its file alone; what left none is submitted again.  When `*stop` is set the job is cancelled and
/// Errc::ConnectionLost says how to go on.  `run.folder` and the programs must be at the same place on every
/// node.  Fails when a command of Slurm is missing or fails, and names shards that are still missing.
[[nodiscard]] Result<void> run_slurm(const BatchRun& run, const SlurmOptions& options,
                                     const BatchProgress& progress, const volatile std::sig_atomic_t* stop);

}  // namespace biteline::batch
