// SPDX-License-Identifier: MIT
#pragma once
/// \file What every command that looks for a line does with the outcome.

#include <filesystem>

#include "common/core/result.hpp"
#include "host/groove/extract.hpp"
#include "host/report/report.hpp"

namespace biteline::result {

/// Removes what an earlier run left in `folder` that a refusal must not leave there (line.csv), and makes the folder.
[[nodiscard]] Result<void> prepare_result_folder(const std::filesystem::path& folder);

/// Writes cloud.ply, line.csv (unless refused), stages/ and report.json; fills the report's fields.  Done or Refused.
[[nodiscard]] Result<ExitStatus> write_line_result(const std::filesystem::path& folder, const cloud::PointCloud& cloud,
                                                   const groove::Extraction& extraction, report::Report& report);

/// One line for a person: what was found or why not.
[[nodiscard]] std::string summary(const groove::Extraction& extraction);

}  // namespace biteline::result
