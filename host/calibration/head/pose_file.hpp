// SPDX-License-Identifier: MIT
#pragma once
/// \file handeye/poses.csv, which people also write by hand, from a pendant or in a spreadsheet.

#include <filesystem>
#include <vector>

#include "common/session/session.hpp"

namespace biteline::calibration {

/// As session::read_pose_table().  Before that it names what a pendant or a spreadsheet makes of it:
/// semicolons, a UR's six numbers, and a head that speaks of the tool's tip.
[[nodiscard]] Result<std::vector<session::StampedPose>> read_hand_eye_poses(
    const std::filesystem::path& file);

}  // namespace biteline::calibration
