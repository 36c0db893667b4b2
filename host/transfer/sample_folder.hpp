// SPDX-License-Identifier: MIT
#pragma once
/// \file A finished sample as replay and extract leave it: cloud.ply and line.csv in one folder.

#include <filesystem>

#include "common/core/result.hpp"
#include "host/cloud/closed_line.hpp"
#include "host/cloud/point_cloud.hpp"

namespace biteline::transfer {

struct SampleFiles {
  cloud::PointCloud cloud{};
  cloud::ClosedLine line{};
};

inline constexpr const char* k_cloud_file = "cloud.ply";
inline constexpr const char* k_line_file = "line.csv";
inline constexpr const char* k_process_file = "process.yaml";  ///< optional: how the model is worked

/// Both are read at the same time.  Fails naming the file, and saying so when the folder is of a scan that
/// was refused.
[[nodiscard]] Result<SampleFiles> read_sample(const std::filesystem::path& folder);

}  // namespace biteline::transfer
