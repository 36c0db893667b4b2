// SPDX-License-Identifier: MIT
#pragma once
/// \file The state in which a calibration's pictures were taken, where their folders tell it.

#include <filesystem>

#include "common/core/result.hpp"
#include "common/geometry/camera_state.hpp"

namespace biteline::calibration {

/// Of CALIB/camera, laser and handeye together (`camera_state.yaml` in each, written by `biteline capture`).
/// Nothing told: none of them has the file.  Errc::Refused by name: two of them were taken in different
/// states.
[[nodiscard]] Result<geometry::CameraState> read_folder_state(const std::filesystem::path& calib);

/// Errc::Refused by name: a scan (session folder) that belongs to the pictures was taken in another state.
[[nodiscard]] Result<void> expect_scan_state(const std::filesystem::path& session,
                                             const geometry::CameraState& pictures);

/// Before pictures are added.  Errc::Refused by name: those that are there were taken in another state.
[[nodiscard]] Result<void> expect_folder_state(const std::filesystem::path& calib,
                                               const geometry::CameraState& now);

}  // namespace biteline::calibration
