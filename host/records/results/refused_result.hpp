// SPDX-License-Identifier: MIT
#pragma once
/// \file What is left of a scan whose line is none, whatever was found in it.

#include <filesystem>

#include "common/core/result.hpp"
#include "host/cloud/point_cloud.hpp"
#include "host/report/report.hpp"

namespace biteline::results {

/// cloud.ply, report.json with the refusal, and index.html that says it.
[[nodiscard]] Result<void> write_refused_result(const std::filesystem::path& folder,
                                                const cloud::PointCloud& cloud,
                                                const report::ToldRefusal& refusal, report::Report& report);

/// view_data.js of whatever was scanned: of no line, and perhaps of no point.
[[nodiscard]] Result<void> write_refused_view(const std::filesystem::path& folder,
                                              const cloud::PointCloud& cloud,
                                              const report::ToldRefusal& refusal,
                                              const report::Report& report);

}  // namespace biteline::results
