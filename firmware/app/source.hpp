// SPDX-License-Identifier: MIT
#pragma once
/// \file Where frames and poses come from: the devices behind a scan.

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/core/result.hpp"
#include "common/geometry/sensor_model.hpp"
#include "common/session/recording_facts.hpp"
#include "common/settings/settings.hpp"
#include "firmware/app/capture.hpp"
#include "firmware/runtime/laser_guard.hpp"
#include "hal/api/edge_in.hpp"
#include "hal/api/gpio_out.hpp"
#include "hal/api/line_camera.hpp"
#include "hal/api/pose_source.hpp"
#include "hal/api/pwm_out.hpp"
#include "hal/api/safety_in.hpp"
#include "hal/api/watchdog.hpp"

namespace biteline::sensor {

/// What feeds one scan.  The camera is configured; nothing is started.
struct Source {
  std::unique_ptr<hal::LineCamera> camera;
  std::unique_ptr<hal::PoseSource> poses;
  std::unique_ptr<hal::PwmOut> trigger;  ///< configured; none: the camera runs by itself
  std::unique_ptr<hal::EdgeIn>
      scan_active;  ///< the robot's word that it is on its way; none: the host alone decides
  std::string scan_name;
  std::uint64_t frames_expected{0};  ///< 0: not known
};

/// The light and what allows it; outlives the scans.
struct LaserDevices {
  std::unique_ptr<hal::GpioOut> laser;
  std::unique_ptr<hal::SafetyIn> safety;
  std::vector<std::unique_ptr<hal::Watchdog>> watchdogs;  ///< armed
  runtime::LaserGuard::Config guard;
};

/// One way to get a scan.
class SourceKind {
 public:
  SourceKind() = default;
  SourceKind(const SourceKind&) = delete;
  SourceKind& operator=(const SourceKind&) = delete;
  virtual ~SourceKind() = default;

  /// Devices opened anew for each scan: what was unplugged and is back is found again.
  [[nodiscard]] virtual Result<Source> open() = 0;
  /// Nothing where there is no laser.
  [[nodiscard]] virtual Result<std::optional<LaserDevices>> open_laser() = 0;
  /// Tells the camera `set` and reads it back, as each scan does; see configure_camera().
  [[nodiscard]] virtual Result<void> try_settings() { return {}; }
  /// Errc::BadValue: at the head's rate the laser's guard would take a camera that runs well for a silent
  /// one.
  [[nodiscard]] virtual Result<void> expect_lit_rate() const { return {}; }

  /// Another set, its head and capture in the place of those: told to the camera and read back as each scan
  /// does, and kept only when it took it.  Between scans.  Pre: they were checked together.
  [[nodiscard]] virtual Result<void> adopt(const geometry::SensorModel& head, const Capture& exposed,
                                           const settings::SettingsSet& wanted);

  /// Asks the camera for `limits` where it was never asked.  Between scans.
  [[nodiscard]] virtual Result<void> learn_limits() { return {}; }

  geometry::SensorModel model;
  geometry::CameraState camera_state;  ///< as the camera told it last; of a recording what it was taken in
  geometry::SensorModel calibrated;    ///< sensor.yaml's own, no set over it; of live devices
  std::filesystem::path head_file;     ///< it, for messages
  hal::CameraLimits limits;            ///< of the camera as it was configured last
  bool limits_known{false};            ///< it has told them
  Capture capture;  ///< checked against the model; of a live recording what it was taken with
  std::optional<settings::SettingsSet> set;         ///< what `--settings` named
  settings::SettingsSet in_use;                     ///< of the camera, since open(); empty of a recording
  std::optional<session::RecordingFacts> recorded;  ///< of a live recording: how peaks were found in it
  bool recording{false};  ///< may be made to wait; played once, from the start of the program
  bool realtime{false};   ///< threads of the devices' own run as the thread table says
  bool simulated{false};  ///< frames and poses are made, not measured
  bool by_way{false};     ///< an encoder asks for each frame: at rest none comes
};

struct SourceOptions {
  std::string source;                                ///< "replay:SESSION" or "board:FILE"
  std::optional<std::filesystem::path> sensor_file;  ///< the head's calibration; replaces a recording's own
  Capture capture;
  std::optional<settings::SettingsSet> set;
};

[[nodiscard]] Result<std::unique_ptr<SourceKind>> choose_source(const SourceOptions& options);

}  // namespace biteline::sensor
