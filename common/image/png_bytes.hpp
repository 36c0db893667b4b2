// SPDX-License-Identifier: MIT
#pragma once
/// \file A grey picture as the bytes of a PNG file.

#include "common/core/result.hpp"
#include "common/image/grey_image.hpp"

namespace biteline::image {

/// Replaces `out`.  Errc::WriteFailed for a picture without pixels.
[[nodiscard]] Result<void> pack_png(const GreyImage& image, std::vector<std::uint8_t>& out);

/// The same without packing: as many bytes as pixels, in less time.
[[nodiscard]] Result<void> store_png(const GreyImage& image, std::vector<std::uint8_t>& out);

}  // namespace biteline::image
