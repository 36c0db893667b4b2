// SPDX-License-Identifier: MIT
#pragma once
/// \file A line as a file of another program's format.

#include <filesystem>

#include "common/core/result.hpp"
#include "host/cloud/closed_line.hpp"

namespace biteline::line_files {

/// Writes `line` (base, mm) as the end of `file`'s name says: .csv .ply .dxf .step .stp .json.  Writes beside
/// and renames.  Fails for another end, and when the file cannot be written.
[[nodiscard]] Result<void> write_line_file(const std::filesystem::path& file, const cloud::ClosedLine& line);

}  // namespace biteline::line_files
