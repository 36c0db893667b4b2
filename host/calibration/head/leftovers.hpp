// SPDX-License-Identifier: MIT
#pragma once
/// \file What of a calibration folder has no partner, or no use: most often a wrong name.

#include <filesystem>
#include <string>
#include <vector>

namespace biteline::calibration {

/// Lines for a person, by name: files that no part reads, stripe pictures without rings and the other way
/// round, poses without a picture.  A folder or table that cannot be read has none: its reader says why.
[[nodiscard]] std::vector<std::string> camera_leftovers(const std::filesystem::path& calib);
[[nodiscard]] std::vector<std::string> laser_leftovers(const std::filesystem::path& calib);
[[nodiscard]] std::vector<std::string> hand_eye_leftovers(const std::filesystem::path& calib);

}  // namespace biteline::calibration
