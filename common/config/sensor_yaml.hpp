// SPDX-License-Identifier: MIT
#pragma once
/// \file sensor.yaml: camera, laser plane and mounting of one scanning head (README, "Data formats").

#include <filesystem>
#include <string>

#include "common/core/result.hpp"
#include "common/geometry/sensor_model.hpp"

namespace biteline::config {

/// Fails with the file, the key and what was expected; T_flange_cam must be a rigid motion, |n| must be 1
/// (both to 1e-4, then made exact).
[[nodiscard]] Result<geometry::SensorModel> read_sensor_yaml(const std::filesystem::path& path);

/// What of a head is known.  What is not is left out of its file: a reader refuses that by name, instead of
/// using a made-up value.
struct KnownParts {
  bool laser_plane{true};
  bool T_flange_cam{true};
};

/// The file's text, numbers with all their digits.  `comment` must be one line.
[[nodiscard]] std::string sensor_yaml_text(const geometry::SensorModel& sensor, const std::string& comment,
                                           KnownParts known = {});

}  // namespace biteline::config
