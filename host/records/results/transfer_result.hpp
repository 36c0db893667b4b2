// SPDX-License-Identifier: MIT
#pragma once
/// \file What every command that carries a sample's line over does with the outcome.

#include <filesystem>
#include <string>

#include "common/core/result.hpp"
#include "host/report/report.hpp"
#include "host/transfer/transfer.hpp"

namespace biteline::results {

/// Writes line.csv (unless refused) and report.json; fills the report's fields.  Done or Refused.
[[nodiscard]] Result<ExitStatus> write_transfer_files(const std::filesystem::path& folder,
                                                      const cloud::PointCloud& upper,
                                                      const transfer::Transfer& transfer,
                                                      report::Report& report);
/// After it: stages/, view and index.html, and report.json again.  Nobody needs to wait for them.  A transfer
/// that was refused before anything was aligned has its reason and no pictures.
[[nodiscard]] Result<void> write_transfer_pages(const std::filesystem::path& folder,
                                                const cloud::PointCloud& upper,
                                                const transfer::Transfer& transfer, report::Report& report);
/// Both.
[[nodiscard]] Result<ExitStatus> write_transfer_result(const std::filesystem::path& folder,
                                                       const cloud::PointCloud& upper,
                                                       const transfer::Transfer& transfer,
                                                       report::Report& report);

/// One line for a person: what was carried over, or why not.
[[nodiscard]] std::string summary(const transfer::Transfer& transfer);

}  // namespace biteline::results
