// SPDX-License-Identifier: MIT
#include "common/image/grey_image.hpp"

#include <CppUTest/TestHarness.h>

#include <fstream>
#include <sstream>

#include "tests/support/errors.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::image {

TEST_GROUP(GreyImage) {
  test::TemporaryFolder folder;
  GreyImage image{.width_px = 37, .height_px = 11, .pixels = std::vector<std::uint8_t>(37 * 11)};

  void setup() override {
    for (std::size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = static_cast<std::uint8_t>(i * 7);
    SUCCEEDS(write_png(folder.path() / "a.png", image));
  }
};

TEST(GreyImage, PngKeepsEveryPixel) {
  const auto sut = read_png(folder.path() / "a.png");
  SUCCEEDS(sut);
  LONGS_EQUAL(37, sut->width_px);
  CHECK(sut->pixels == image.pixels);
  LONGS_EQUAL(image.at(36, 10), sut->row(10)[36]);
}

TEST(GreyImage, OtherSizeThanExpectedIsRefused) {
  std::vector<std::uint8_t> pixels(37 * 12);
  FAILS_NAMING(Errc::SizeMismatch, "37 x 12 px expected, found 37 x 11",
               read_png_into(folder.path() / "a.png", 37, 12, pixels));
}

TEST(GreyImage, TruncatedAndForeignFilesAreRefused) {
  std::ifstream file(folder.path() / "a.png", std::ios::binary);
  std::ostringstream bytes;
  bytes << file.rdbuf();
  for (const std::size_t kept : {0UL, 10UL, 40UL, bytes.str().size() / 2}) {
    CHECK(!read_png(folder.write("cut.png", bytes.str().substr(0, kept))));
  }
  FAILS_NAMING(Errc::BadFormat, "words.png",
               read_png(folder.write("words.png", "these are words and no picture at all")));
  FAILS_NAMING(Errc::FileNotFound, "none.png", read_png(folder.path() / "none.png"));
}

}  // namespace biteline::image
