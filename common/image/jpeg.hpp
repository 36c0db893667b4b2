// SPDX-License-Identifier: MIT
#pragma once
/// \file 8-bit grey pictures as JPEG, in memory.

#include <cstdint>
#include <span>
#include <vector>

#include "common/core/result.hpp"
#include "common/image/grey_image.hpp"

namespace biteline::image {

/// `quality` 1 to 100.
[[nodiscard]] Result<std::vector<std::uint8_t>> encode_jpeg(const GreyImage& image, int quality);

/// Of at most 64 million pixels; colour becomes grey.  Errc::BadFormat: no JPEG, or a damaged one.
[[nodiscard]] Result<GreyImage> decode_jpeg(std::span<const std::uint8_t> file);

}  // namespace biteline::image
