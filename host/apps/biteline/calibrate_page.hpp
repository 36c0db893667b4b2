// SPDX-License-Identifier: MIT
#pragma once
/// \file index.html beside a calibration's report.json: the verdict, what to take again, and the pictures.

#include <filesystem>
#include <nlohmann/json.hpp>

#include "common/core/result.hpp"
#include "host/calibration/head/verdict.hpp"

namespace biteline::app {

/// `fields`: the report's own; `folder` holds stages/.
[[nodiscard]] Result<void> write_calibration_page(const nlohmann::ordered_json& fields,
                                                  const calibration::Verdict& verdict,
                                                  const std::filesystem::path& folder);

}  // namespace biteline::app
