// SPDX-License-Identifier: MIT
#pragma once
/// \file What is wrong with a calibration folder as a whole, before any part of it is looked at: else each
/// part would blame target, poses or lens.

#include <optional>

#include "host/calibration/head/head_calibration.hpp"

namespace biteline::calibration {

/// Raw mosaics, sizes that differ between the parts, poses that stand still: the first of them, in one
/// sentence.
[[nodiscard]] std::optional<Refusal> input_fault(const HeadInput& input);

}  // namespace biteline::calibration
