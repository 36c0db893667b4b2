// SPDX-License-Identifier: MIT
#pragma once
/// \file What a head's settings ask of live devices.

#include <filesystem>

#include "common/core/result.hpp"
#include "common/geometry/sensor_model.hpp"
#include "firmware/app/capture.hpp"
#include "hal/api/line_camera.hpp"
#include "hal/api/pwm_out.hpp"

namespace biteline::sensor {

/// A sensor.yaml that says rate and exposure; without them no camera can be run.
[[nodiscard]] Result<geometry::SensorModel> read_live_head(const std::filesystem::path& sensor_file);

/// The camera as the head was calibrated: Errc::DeviceError when it takes another region.
/// Pre: `head` is from read_live_head().
[[nodiscard]] Result<void> configure_as_head(hal::LineCamera& camera, const geometry::SensorModel& head,
                                             const Capture& capture, hal::Trigger trigger);

/// One pulse for each frame, as long as the longest exposure that may occur.
[[nodiscard]] hal::PwmSettings train_of(const geometry::SensorModel& head, const Capture& capture);

}  // namespace biteline::sensor
