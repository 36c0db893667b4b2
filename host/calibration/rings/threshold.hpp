// SPDX-License-Identifier: MIT
#pragma once
/// \file Dark or bright: a threshold that follows uneven light.

#include <cstdint>
#include <vector>

#include "common/image/grey_image.hpp"

namespace biteline::calibration {

/// 255 where the picture is darker than its surroundings' threshold, 0 elsewhere.
///
/// The picture is cut into windows of `window_px` overlapping by half.  A window whose histogram has two
/// peaks gives a threshold, the valley between them; windows without (all plate, all background) take their
/// neighbours'.  Between window centres the threshold is interpolated, so that a lamp on one side does not
/// matter.
[[nodiscard]] std::vector<std::uint8_t> dark_mask(const image::GreyImage& picture, int window_px);

}  // namespace biteline::calibration
