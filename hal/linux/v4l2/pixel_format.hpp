// SPDX-License-Identifier: MIT
#pragma once
/// \file Grey formats of V4L2 and their way to 8 bits.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "common/core/result.hpp"

namespace biteline::hal {

enum class PixelFormat {
  Grey8,         ///< GREY
  Grey10In16,    ///< Y10, little endian, upper bits 0
  Grey12In16,    ///< Y12
  Grey16,        ///< Y16
  Grey10Packed,  ///< Y10P, MIPI CSI-2: four upper bytes, then their low bits
  Grey12Packed,  ///< Y12P, MIPI CSI-2: two upper bytes, then their low bits
};

/// In the order of preference: the least to be moved and unpacked first.
inline constexpr std::array k_pixel_formats{PixelFormat::Grey8,        PixelFormat::Grey10Packed,
                                            PixelFormat::Grey12Packed, PixelFormat::Grey10In16,
                                            PixelFormat::Grey12In16,   PixelFormat::Grey16};

[[nodiscard]] std::uint32_t fourcc_of(PixelFormat format);
/// Bytes that `width_px` pixels take in a row, padding apart.
[[nodiscard]] std::size_t row_bytes(PixelFormat format, int width_px);

struct RawPicture {
  std::span<const std::uint8_t> bytes;
  std::size_t stride_bytes{0};
  PixelFormat format{PixelFormat::Grey8};
};

struct PictureWindow {
  int offset_u_px{0}, offset_v_px{0};
  int width_px{0}, height_px{0};
};

/// Cuts the window out and keeps the upper eight bits of each pixel; `out` holds width * height bytes.
/// Errc::SizeMismatch: the picture has fewer bytes than the window needs.  RT: no allocation.
[[nodiscard]] Result<void> to_grey8(const RawPicture& picture, const PictureWindow& window,
                                    std::span<std::uint8_t> out);

}  // namespace biteline::hal
