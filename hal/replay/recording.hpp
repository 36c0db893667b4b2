// SPDX-License-Identifier: MIT
#pragma once
/// \file Opens a recorded session for replay, with another head's calibration if asked.

#include <filesystem>
#include <memory>
#include <optional>

#include "common/session/session.hpp"

namespace biteline::hal::replay {

/// With `sensor_file` its intrinsics, distortion, laser plane and T_flange_cam replace the session's; region,
/// rate, exposure and clock offset stay the session's, since they describe the recording and not the head.
[[nodiscard]] Result<std::shared_ptr<const session::Session>> open_recording(
    const std::filesystem::path& folder, const std::optional<std::filesystem::path>& sensor_file);

}  // namespace biteline::hal::replay
