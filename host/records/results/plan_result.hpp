// SPDX-License-Identifier: MIT
#pragma once
/// \file What every command that plans a path does with the outcome.

#include <filesystem>
#include <string>

#include "common/core/result.hpp"
#include "host/report/report.hpp"
#include "host/robot/path/plan.hpp"
#include "host/robot/path/track.hpp"

namespace biteline::results {

/// Makes the folder and removes what an earlier run left: a refused plan leaves no path behind.
[[nodiscard]] Result<void> prepare_plan_folder(const std::filesystem::path& folder);

/// Why the gate would not let the path through, where its uncertainty is beyond the process's tolerance or
/// not known; empty when it is certain enough.
[[nodiscard]] std::string uncertainty_warning(const path::PlanRequest& request,
                                              const path::PlanOutcome& outcome);

/// tracking.html: the arm following the path, and the recorded track when there is one.  Pre: the outcome has
/// a path.
[[nodiscard]] Result<void> write_tracking(const std::filesystem::path& folder,
                                          const path::PlanRequest& request, const path::PlanOutcome& outcome,
                                          const std::vector<path::TrackSample>& track);

/// Writes path.csv, path.script and tracking.html (unless refused) and report.json with every check; Done or
/// Refused.
[[nodiscard]] Result<ExitStatus> write_plan_result(const std::filesystem::path& folder,
                                                   const path::PlanRequest& request,
                                                   const path::PlanOutcome& outcome, report::Report& report);

}  // namespace biteline::results
