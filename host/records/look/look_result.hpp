// SPDX-License-Identifier: MIT
#pragma once
/// \file A second look's result: report.json, band.csv and band.svg, and what it says to people.

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>

#include "host/report/report.hpp"
#include "host/second_look/second_look.hpp"

namespace biteline::look {

/// Of which scans, line and process; SHA-256 of the files.
struct LookOf {
  std::string first, second;
  std::string line_sha256, process_sha256;
  std::string foot{};      ///< empty: nobody told it
  std::size_t reworks{0};  ///< that there were before it
  /// Where the path meets its begin again, along the line, mm; nothing: it does not, or nobody knows.
  std::optional<double> path_end_mm{};
};

/// Done, Review where something is missing, beside its place or not to be told, or Refused.
struct Judged {
  ExitStatus status{ExitStatus::Done};
  report::ToldRefusal told{};  ///< empty: Done
};

/// Writes the folder's files but report.json; fills and judges the report.
[[nodiscard]] Result<Judged> write_look_result(const std::filesystem::path& folder,
                                               const second_look::Findings& findings,
                                               const second_look::PlannedBand& plan, const LookOf& of,
                                               report::Report& report);

/// How much is worked, and a line for each fault.
[[nodiscard]] std::string summary(const second_look::Findings& findings);

}  // namespace biteline::look
