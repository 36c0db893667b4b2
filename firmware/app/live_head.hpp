// SPDX-License-Identifier: MIT
#pragma once
/// \file What a head's settings ask of live devices.

#include <filesystem>
#include <optional>

#include "common/core/result.hpp"
#include "common/geometry/sensor_model.hpp"
#include "common/settings/settings.hpp"
#include "firmware/app/capture.hpp"
#include "firmware/runtime/laser_guard.hpp"
#include "hal/api/line_camera.hpp"
#include "hal/api/pwm_out.hpp"
#include "hal/board/board.hpp"

namespace biteline::sensor {

/// A sensor.yaml with the set's region, rate and exposure over its own.  Without a rate and an exposure in
/// either of them no camera can be run.
[[nodiscard]] Result<geometry::SensorModel> read_live_head(const std::filesystem::path& sensor_file,
                                                           const std::optional<settings::SettingsSet>& set);

/// As read_live_head(), of a sensor.yaml that was read; `file` is its name for messages.
[[nodiscard]] Result<geometry::SensorModel> with_set(geometry::SensorModel head,
                                                     const std::optional<settings::SettingsSet>& set,
                                                     const std::filesystem::path& file);

/// What was told, and beneath it what the set says.
[[nodiscard]] Capture put_over(const Capture& told, const settings::SettingsSet& set);

/// A camera as the head was calibrated and the set says.
struct LiveSettings {
  hal::CameraSettings camera;
  std::optional<settings::SettingsSet> set;  ///< where `camera` has numbers of it; for messages
};
[[nodiscard]] LiveSettings live_settings(const geometry::SensorModel& head, const Capture& capture,
                                         hal::Trigger trigger,
                                         const std::optional<settings::SettingsSet>& set);

/// Errc::BadValue, as configure_camera(): what a camera of these limits does not take.  Nothing is told to
/// it.
[[nodiscard]] Result<void> check_limits(const LiveSettings& wanted, const hal::CameraLimits& limits);

/// The guard's limits on this board: its own, or the patience that a simulated board states.
[[nodiscard]] runtime::LaserGuard::Config guard_of(const hal::BoardLaser& laser);

/// Errc::BadValue: fewer pictures a second than the laser's guard needs, which is one and a half periods
/// within its time for a silent camera (20 Hz).  Every scan at such a rate would go dark at the first late
/// picture. Not looked at: boards without a laser, and those whose encoder asks for each picture.
[[nodiscard]] Result<void> check_lit_rate(const LiveSettings& wanted, const hal::Board& board);

/// Cameras count exposures in lines: so near is as asked.  0 taken: the driver cannot say it.
[[nodiscard]] bool is_as_asked(Nanoseconds asked, Nanoseconds taken);

/// Checks everything first, then tells the camera, then reads back.  Gives back what the camera took.
///
/// Errc::BadValue, NotSupported: what the camera does not take, with the set's file, line, key and range
/// where the set asked for it; nothing was told to the camera then.  When it fails or takes something else in
/// the middle, `former` is put back (none: nothing is known to put back). Pre: the head is from
/// read_live_head().
[[nodiscard]] Result<hal::CameraSettings> configure_camera(hal::LineCamera& camera,
                                                           const LiveSettings& wanted,
                                                           const std::optional<hal::CameraSettings>& former);

/// One pulse for each frame, as long as the longest exposure that may occur.
[[nodiscard]] hal::PwmSettings train_of(const geometry::SensorModel& head, const Capture& capture);

/// The set that is in use, whole: what the camera took, and the rest as told.
[[nodiscard]] settings::SettingsSet set_in_use(const hal::CameraSettings& taken,
                                               const geometry::SensorModel& head, const Capture& capture);

}  // namespace biteline::sensor
