// SPDX-License-Identifier: MIT
#include "common/image/jpeg.hpp"

#include <CppUTest/TestHarness.h>

#include <cstdlib>

#include "tests/support/errors.hpp"

namespace biteline::image {
namespace {

/// Smooth, so that a JPEG of high quality stays within a few grey levels of it.
GreyImage made_image() {
  GreyImage image{.width_px = 61, .height_px = 37, .pixels = {}};
  for (int v = 0; v < image.height_px; ++v) {
    for (int u = 0; u < image.width_px; ++u) image.pixels.push_back(static_cast<std::uint8_t>(2 * u + 3 * v));
  }
  return image;
}

}  // namespace

TEST_GROUP(Jpeg){};

TEST(Jpeg, PictureComesBackAlike) {
  const GreyImage image = made_image();
  const auto file = encode_jpeg(image, 95);
  SUCCEEDS(file);
  const auto back = decode_jpeg(*file);
  SUCCEEDS(back);
  LONGS_EQUAL(image.width_px, back->width_px);
  LONGS_EQUAL(image.height_px, back->height_px);
  int worst = 0;
  for (std::size_t i = 0; i < image.pixels.size(); ++i)
    worst = std::max(worst, std::abs(int{image.pixels[i]} - int{back->pixels[i]}));
  // Quality 95 quantises in steps of at most 12 / 2 grey levels per coefficient; few coefficients are in use
  // here.
  CHECK(worst <= 6);
}

TEST(Jpeg, LowerQualityIsSmaller) {
  CHECK(encode_jpeg(made_image(), 20)->size() < encode_jpeg(made_image(), 95)->size());
}

TEST(Jpeg, CutAndForeignFilesAreRefused) {
  const auto file = encode_jpeg(made_image(), 75);
  SUCCEEDS(file);
  for (std::size_t size = 0; size < file->size(); ++size) {
    FAILS_NAMING(Errc::BadFormat, "JPEG", decode_jpeg({file->data(), size}));
  }
  const std::vector<std::uint8_t> rubbish(500, 0x42);
  FAILS_NAMING(Errc::BadFormat, "JPEG", decode_jpeg(rubbish));
}

}  // namespace biteline::image
