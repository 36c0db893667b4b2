// SPDX-License-Identifier: MIT
#pragma once
/// \file uncertainty.yaml: how well the head of the sensor.yaml beside it is known.

#include <filesystem>
#include <optional>
#include <string>

#include "common/core/result.hpp"
#include "host/cloud/uncertainty/head_uncertainty.hpp"

namespace biteline::uncertainty {

inline constexpr const char* k_file_name = "uncertainty.yaml";

/// Strict: a covariance must be symmetric with nothing negative on its diagonal.
[[nodiscard]] Result<HeadUncertainty> read_uncertainty(const std::filesystem::path& file);
/// Of the file beside a sensor.yaml; nothing where there is none.
[[nodiscard]] Result<std::optional<HeadUncertainty>> read_uncertainty_beside(
    const std::filesystem::path& sensor_yaml);

[[nodiscard]] std::string uncertainty_text(const HeadUncertainty& uncertainty);

}  // namespace biteline::uncertainty
