// SPDX-License-Identifier: MIT
#pragma once
/// \file --unit and --up, and what commands say of the clouds they read.

#include <nlohmann/json.hpp>
#include <string>

#include "common/options/command.hpp"
#include "host/cloud/cloud_file.hpp"

namespace biteline::app {

/// What a command says of its cloud in --help.
inline constexpr const char* k_cloud_kinds = "PLY, XYZ, CSV, PCD, STL or OBJ; mm, or as --unit says";

/// `--unit mm|cm|m|um|in` and `--up z|-z|y|-y|x|-x` of the cloud that the command reads.
void add_reading_options(options::Command& command, cloud::Reading& reading);

/// Fails for a file whose points lie far from its origin, where something else must lie in the same frame.
[[nodiscard]] Result<void> near_origin(const cloud::CloudFile& file, const std::filesystem::path& path);

/// `cloud_file` of report.json: how the file was understood.
[[nodiscard]] nlohmann::ordered_json as_json(const cloud::CloudFile& file, const cloud::Reading& reading);

}  // namespace biteline::app
