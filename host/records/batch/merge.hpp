// SPDX-License-Identifier: MIT
#pragma once
/// \file The finished shards of a run as one SQLite file and one page.

#include <filesystem>

#include "common/core/result.hpp"
#include "host/records/batch/result_set.hpp"
#include "host/records/batch/run.hpp"

namespace biteline::batch {

/// Writes batch.sqlite into `out` and returns what stands in it.  Fails while shards are missing.
[[nodiscard]] Result<ResultSet> merge_run(const BatchRun& run, const std::filesystem::path& out);

/// index.html and the pictures of the `pictures` worst lines beside it.  `plan`: where truths are.
[[nodiscard]] Result<void> write_results_page(const ResultSet& results, const BatchPlan& plan,
                                              const std::filesystem::path& out, int pictures);

}  // namespace biteline::batch
