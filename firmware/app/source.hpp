// SPDX-License-Identifier: MIT
#pragma once
/// \file Where frames and poses come from: the devices behind one scan, opened.

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "common/core/result.hpp"
#include "common/geometry/sensor_model.hpp"
#include "hal/api/line_camera.hpp"
#include "hal/api/pose_source.hpp"

namespace biteline::sensor {

/// What feeds a scan.  The camera is configured; nothing is started.
struct Source {
  std::unique_ptr<hal::LineCamera> camera;
  std::unique_ptr<hal::PoseSource> poses;
  geometry::SensorModel model;
  std::string scan_name;
  std::uint64_t frames_expected{0};  ///< 0: not known
  bool lossless{false};              ///< may be made to wait: a recording
  bool simulated{false};             ///< frames and poses are made, not measured
};

struct SourceOptions {
  std::string source;                                ///< "replay:SESSION"
  std::optional<std::filesystem::path> sensor_file;  ///< replaces the head's calibration
};

[[nodiscard]] Result<Source> open_source(const SourceOptions& options);

}  // namespace biteline::sensor
