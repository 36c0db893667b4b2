// SPDX-License-Identifier: MIT
#pragma once
/// \file 8-bit grey pictures and their PNG files.

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "common/core/result.hpp"

namespace biteline::image {

struct GreyImage {
  int width_px{0};
  int height_px{0};
  std::vector<std::uint8_t> pixels;  ///< row-major, no padding

  [[nodiscard]] std::span<const std::uint8_t> row(int v_px) const {
    return std::span{pixels}.subspan(static_cast<std::size_t>(v_px) * static_cast<std::size_t>(width_px),
                                     static_cast<std::size_t>(width_px));
  }
  [[nodiscard]] std::uint8_t at(int u_px, int v_px) const {
    return pixels[static_cast<std::size_t>(v_px) * static_cast<std::size_t>(width_px) +
                  static_cast<std::size_t>(u_px)];
  }
};

/// Reads an 8-bit grey PNG; anything else (colour, 16 bit, truncated, not a PNG) fails with the file and the
/// reason.
[[nodiscard]] Result<GreyImage> read_png(const std::filesystem::path& path);

/// As read_png() into a buffer of the caller's; fails with SizeMismatch when the picture is not width x
/// height.
[[nodiscard]] Result<void> read_png_into(const std::filesystem::path& path, int width_px, int height_px,
                                         std::span<std::uint8_t> pixels);

[[nodiscard]] Result<void> write_png(const std::filesystem::path& path, const GreyImage& image);

}  // namespace biteline::image
