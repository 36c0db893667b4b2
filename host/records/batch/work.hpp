// SPDX-License-Identifier: MIT
#pragma once
/// \file One recording through the programs of a build, in a process of its own.

#include <filesystem>
#include <string>

#include "common/core/result.hpp"
#include "host/records/batch/limited_process.hpp"
#include "host/records/batch/outcome.hpp"
#include "host/records/batch/plan.hpp"

namespace biteline::batch {

/// The programs whose results are filed together.
struct BatchBuild {
  std::filesystem::path program;  ///< `biteline`; its sister biteline-sensor replays sessions
  std::filesystem::path cell;     ///< `biteline-cell`, for what is made
  std::string identity;           ///< SHA-256 of program and sister
};

/// Hashes the programs.  Fails when `program` is missing.
[[nodiscard]] Result<BatchBuild> build_of(const std::filesystem::path& program,
                                          const std::filesystem::path& cell);

struct Worked {
  Outcome outcome;
  Cost cost;
  std::string line_csv;  ///< empty without a line
};

/// Whatever the recording does to its process is an outcome.  Fails only where this machine fails: no
/// scratch folder, no process.
[[nodiscard]] Result<Worked> work_on(const Recording& recording, const BatchSettings& settings,
                                     const BatchBuild& build, const ProcessLimits& limits);

}  // namespace biteline::batch
