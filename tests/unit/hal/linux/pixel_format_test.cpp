// SPDX-License-Identifier: MIT
#include "hal/linux/v4l2/pixel_format.hpp"

#include <CppUTest/TestHarness.h>

#include <random>
#include <vector>

#include "hal/linux/v4l2/controls.hpp"
#include "hal/linux/v4l2/v4l2_camera.hpp"

namespace biteline::hal {
namespace {

using namespace std::chrono_literals;

/// Oracle: packs 16-bit pixels the way the kernel's documentation draws each format.
std::vector<std::uint8_t> packed(PixelFormat format, const std::vector<std::uint16_t>& pixels) {
  std::vector<std::uint8_t> bytes;
  const auto low_byte = [](unsigned value) { return static_cast<std::uint8_t>(value); };
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    switch (format) {
      case PixelFormat::Grey8:
        bytes.push_back(low_byte(pixels[i] >> 8U));
        break;
      case PixelFormat::Grey10In16:
      case PixelFormat::Grey12In16:
      case PixelFormat::Grey16: {
        const unsigned shift = format == PixelFormat::Grey10In16   ? 6
                               : format == PixelFormat::Grey12In16 ? 4
                                                                   : 0;
        bytes.push_back(low_byte(pixels[i] >> shift));
        bytes.push_back(low_byte(pixels[i] >> shift >> 8U));
        break;
      }
      case PixelFormat::Grey10Packed:
        bytes.push_back(low_byte(pixels[i] >> 8U));
        if (i % 4 == 3) {
          unsigned low_bits = 0;
          for (std::size_t k = 0; k < 4; ++k) low_bits |= (pixels[i - 3 + k] >> 6U & 3U) << 2 * k;
          bytes.push_back(low_byte(low_bits));
        }
        break;
      case PixelFormat::Grey12Packed:
        bytes.push_back(low_byte(pixels[i] >> 8U));
        if (i % 2 == 1) {
          bytes.push_back(low_byte((pixels[i - 1] >> 4U & 15U) | (pixels[i] >> 4U & 15U) << 4U));
        }
        break;
    }
  }
  return bytes;
}

TEST_GROUP(ToGrey8){};

TEST(ToGrey8, EveryFormatGivesTheUpperBitsOfTheWindow) {
  constexpr int k_width_px = 24;
  constexpr int k_height_px = 5;
  constexpr PictureWindow k_window{.offset_u_px = 5, .offset_v_px = 2, .width_px = 13, .height_px = 3};
  std::mt19937 random{9};
  std::vector<std::uint16_t> pixels(k_width_px * k_height_px);
  for (std::uint16_t& pixel : pixels) pixel = static_cast<std::uint16_t>(random());
  for (const PixelFormat format : k_pixel_formats) {
    const std::vector<std::uint8_t> bytes = packed(format, pixels);
    std::vector<std::uint8_t> out(13 * 3);
    CHECK(to_grey8({.bytes = bytes, .stride_bytes = row_bytes(format, k_width_px), .format = format},
                   k_window, out)
              .has_value());
    for (int v = 0; v < 3; ++v) {
      for (int u = 0; u < 13; ++u) {
        CHECK_EQUAL(pixels[static_cast<std::size_t>((v + 2) * k_width_px + u + 5)] >> 8,
                    out[static_cast<std::size_t>(v * 13 + u)]);
      }
    }
  }
}

TEST(ToGrey8, PictureCutShortIsRefused) {
  std::vector<std::uint8_t> out(16);
  for (const PixelFormat format : k_pixel_formats) {
    const std::size_t stride_bytes = row_bytes(format, 8);
    const std::vector<std::uint8_t> bytes(stride_bytes * 2 - 1);
    const RawPicture picture{.bytes = bytes, .stride_bytes = stride_bytes, .format = format};
    CHECK(to_grey8(picture, {.width_px = 8, .height_px = 2}, out).error().code == Errc::SizeMismatch);
  }
}

TEST_GROUP(ExposureRegister) {
  ExposureRegister sut{.id = 1, .unit = 100us, .minimum = 3, .maximum = 40, .step = 5};
};

TEST(ExposureRegister, NearestStepIsTaken) {
  CHECK_EQUAL(13, sut.steps_for(1250us).value());
  CHECK_EQUAL(38, sut.steps_for(4000us).value());  // 43 would be nearest and is beyond the range
}

TEST(ExposureRegister, BeyondTheRangeIsRefused) {
  CHECK(sut.steps_for(200us).error().code == Errc::BadValue);
  CHECK(sut.steps_for(10ms).error().code == Errc::BadValue);
}

TEST_GROUP(V4l2Camera){};

TEST(V4l2Camera, WhatIsNoCameraIsSaid) {
  CHECK(V4l2Camera::open({.device = "/dev/biteline-no-such-camera"}).error().code == Errc::DeviceNotFound);
  CHECK(V4l2Camera::open({.device = "/dev/null"}).error().code == Errc::NotSupported);
}

}  // namespace
}  // namespace biteline::hal
