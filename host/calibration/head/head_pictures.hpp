// SPDX-License-Identifier: MIT
#pragma once
/// \file Pictures of a calibration: what was found where, how well it fits, what is uncovered.

#include <filesystem>

#include "host/calibration/head/head_calibration.hpp"

namespace biteline::calibration {

/// Writes into `folder`: rings_camera.png, rings_laser.png, rings_handeye.png (every picture, small, with
/// what was found in it), coverage.png (all centres, residuals as arrows), stripe.png (stripe points off the
/// laser plane), and left_out.png (each stop's error as told by the others).
[[nodiscard]] Result<void> draw_calibration(const HeadCalibration& calibration,
                                            const std::filesystem::path& calib,
                                            const std::filesystem::path& folder);

}  // namespace biteline::calibration
