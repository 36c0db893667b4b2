// SPDX-License-Identifier: MIT
#include "hal/linux/v4l2/pixel_format.hpp"

#include <linux/videodev2.h>

#include <cstring>

#include "common/core/contracts.hpp"

namespace biteline::hal {
namespace {

// Not in the headers of Linux 6.1; the code is fixed by the kernel's documentation (Packed greyscale
// formats).
constexpr std::uint32_t k_fourcc_y12p = v4l2_fourcc('Y', '1', '2', 'P');

/// Pixels of a group that shares bytes, and those bytes: every group starts on a byte.
struct Packing {
  std::size_t pixels;
  std::size_t bytes;
};

Packing packing_of(PixelFormat format) {
  switch (format) {
    case PixelFormat::Grey8:
      return {1, 1};
    case PixelFormat::Grey10In16:
    case PixelFormat::Grey12In16:
    case PixelFormat::Grey16:
      return {1, 2};
    case PixelFormat::Grey10Packed:
      return {4, 5};
    case PixelFormat::Grey12Packed:
      return {2, 3};
  }
  return {1, 1};
}

void narrow_row(const std::uint8_t* row, std::size_t first_px, std::span<std::uint8_t> out, unsigned shift) {
  for (std::size_t i = 0; i < out.size(); ++i) {
    const std::uint8_t* pixel = row + 2 * (first_px + i);
    const unsigned value = pixel[0] | static_cast<unsigned>(pixel[1]) << 8U;
    out[i] = static_cast<std::uint8_t>(value >> shift);
  }
}

/// The upper bytes stand first in each group, in the order of the pixels.
void unpack_row(const std::uint8_t* row, std::size_t first_px, std::span<std::uint8_t> out, Packing packing) {
  for (std::size_t i = 0; i < out.size(); ++i) {
    const std::size_t pixel = first_px + i;
    out[i] = row[pixel / packing.pixels * packing.bytes + pixel % packing.pixels];
  }
}

}  // namespace

std::uint32_t fourcc_of(PixelFormat format) {
  switch (format) {
    case PixelFormat::Grey8:
      return V4L2_PIX_FMT_GREY;
    case PixelFormat::Grey10In16:
      return V4L2_PIX_FMT_Y10;
    case PixelFormat::Grey12In16:
      return V4L2_PIX_FMT_Y12;
    case PixelFormat::Grey16:
      return V4L2_PIX_FMT_Y16;
    case PixelFormat::Grey10Packed:
      return V4L2_PIX_FMT_Y10P;
    case PixelFormat::Grey12Packed:
      return k_fourcc_y12p;
  }
  return 0;
}

std::size_t row_bytes(PixelFormat format, int width_px) {
  const Packing packing = packing_of(format);
  const auto width = static_cast<std::size_t>(width_px);
  return (width + packing.pixels - 1) / packing.pixels * packing.bytes;
}

Result<void> to_grey8(const RawPicture& picture, const PictureWindow& window, std::span<std::uint8_t> out) {
  const auto width = static_cast<std::size_t>(window.width_px);
  const auto height = static_cast<std::size_t>(window.height_px);
  const auto first_row = static_cast<std::size_t>(window.offset_v_px);
  const auto first_px = static_cast<std::size_t>(window.offset_u_px);
  BITELINE_EXPECTS(window.width_px > 0 && window.height_px > 0 && out.size() == width * height);
  const std::size_t used_row_bytes = row_bytes(picture.format, window.offset_u_px + window.width_px);
  const std::size_t needed_bytes = (first_row + height - 1) * picture.stride_bytes + used_row_bytes;
  if (used_row_bytes > picture.stride_bytes || picture.bytes.size() < needed_bytes) {
    return fail(Errc::SizeMismatch, "picture of %zu bytes, %zu needed", picture.bytes.size(), needed_bytes);
  }
  for (std::size_t v = 0; v < height; ++v) {
    const std::uint8_t* row = picture.bytes.data() + (first_row + v) * picture.stride_bytes;
    const std::span<std::uint8_t> out_row = out.subspan(v * width, width);
    switch (picture.format) {
      case PixelFormat::Grey8:
        std::memcpy(out_row.data(), row + first_px, width);
        break;
      case PixelFormat::Grey10In16:
        narrow_row(row, first_px, out_row, 2);
        break;
      case PixelFormat::Grey12In16:
        narrow_row(row, first_px, out_row, 4);
        break;
      case PixelFormat::Grey16:
        narrow_row(row, first_px, out_row, 8);
        break;
      case PixelFormat::Grey10Packed:
      case PixelFormat::Grey12Packed:
        unpack_row(row, first_px, out_row, packing_of(picture.format));
        break;
    }
  }
  return {};
}

}  // namespace biteline::hal
