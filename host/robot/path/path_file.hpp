// SPDX-License-Identifier: MIT
#pragma once
/// \file path.csv: the path for people and other programs.

#include <filesystem>

#include "common/core/result.hpp"
#include "host/robot/path/checks/checked_path.hpp"

namespace biteline::path {

/// One row per waypoint: time, segment, T_base_tcp as position and quaternion, speed of the tip, six joints,
/// arc length, U95 (empty: not known, or not on the line).
[[nodiscard]] Result<void> write_path(const std::filesystem::path& file, const CheckedPath& path);

}  // namespace biteline::path
