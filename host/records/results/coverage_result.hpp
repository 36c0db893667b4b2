// SPDX-License-Identifier: MIT
#pragma once
/// \file What of the shoe a planned path covers, drawn on its cloud before anything is sent.

#include <filesystem>

#include "common/core/result.hpp"
#include "host/report/report.hpp"
#include "host/robot/path/plan.hpp"

namespace biteline::results {

/// coverage.ply (the cloud, in colours, with how often the tool comes over each point), coverage.png, and
/// `coverage` of the report.  Nothing of a request without a cloud, of a refused one, or of a process without
/// a width.  Before write_plan_result(), whose page shows it.
[[nodiscard]] Result<void> write_coverage(const std::filesystem::path& folder,
                                          const path::PlanRequest& request, const path::PlanOutcome& outcome,
                                          report::Report& report);

}  // namespace biteline::results
