// SPDX-License-Identifier: MIT
#pragma once
/// \file The raw mosaic of a colour sensor, told by its pattern of 2 x 2 pixels.

#include "common/image/grey_image.hpp"

namespace biteline::calibration {

/// Each pixel saw one colour only: neighbours differ by a pattern that repeats every second pixel both ways,
/// nearly everywhere in the picture.  Rows or columns that take turns (interlaced, two amplifiers) are none.
[[nodiscard]] bool is_mosaic(const image::GreyImage& picture);

inline constexpr const char* k_mosaic_words = "looks like the raw mosaic of a colour sensor";

}  // namespace biteline::calibration
