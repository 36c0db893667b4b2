// SPDX-License-Identifier: MIT
#pragma once
/// \file The camera's state as YAML: the block `camera_state` of sensor.yaml, and the file of that name
/// beside calibration pictures.

#include <filesystem>
#include <string>

#include "common/config/yaml_reader.hpp"
#include "common/geometry/camera_state.hpp"

namespace biteline::config {

inline constexpr const char* k_camera_state_file = "camera_state.yaml";

/// Of a mapping; what is not there was not told.  Faults join the reader's.
[[nodiscard]] geometry::CameraState read_camera_state(YamlReader& reader);
[[nodiscard]] Result<geometry::CameraState> read_camera_state(const std::filesystem::path& file);

/// A line for each value that is told, `indent` before it.
[[nodiscard]] std::string camera_state_text(const geometry::CameraState& state, const std::string& indent);

}  // namespace biteline::config
