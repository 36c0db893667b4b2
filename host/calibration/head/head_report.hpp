// SPDX-License-Identifier: MIT
#pragma once
/// \file A calibration in words and numbers for report.json: RMS and standard deviation of every quantity.

#include <nlohmann/json.hpp>

#include "host/calibration/head/head_calibration.hpp"

namespace biteline::calibration {

/// Fields camera, laser, hand_eye, set_aside; of the parts that were calibrated.
[[nodiscard]] nlohmann::ordered_json report_fields(const HeadCalibration& calibration);

}  // namespace biteline::calibration
