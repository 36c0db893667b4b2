// SPDX-License-Identifier: MIT
#pragma once
/// \file A camera started for a few frames in the dark: what only a running stream tells.

#include <optional>
#include <string>

#include "firmware/app/board_devices.hpp"

namespace biteline::sensor {

/// Opens the camera, sets it up (as `head` was calibrated; the whole sensor where there is none), starts it
/// with its trigger, takes three frames and stops.  Says what was seen: "3 frames of 1626 x 320".
///
/// A camera that waits for somebody else's edges (an encoder's, the robot's) is started, and no frame is
/// waited for.  Errc::Timeout: no frame came; Errc::DeviceError: all were damaged; Errc::Refused: not in the
/// state of the calibration.
[[nodiscard]] Result<std::string> look_through_camera(const BoardDevices& devices,
                                                      const std::optional<geometry::SensorModel>& head);

}  // namespace biteline::sensor
