// SPDX-License-Identifier: MIT
#include "common/image/grey_image.hpp"

#include <CppUTest/TestHarness.h>

#include <spng.h>
#include <sys/stat.h>

#include <cstdlib>
#include <cstring>
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

TEST(GreyImage, TextThatUnpacksToFarMoreThanThePictureIsRefused) {
  // 8 MB of one letter pack to some kilobytes.
  std::string bomb(8U << 20U, 'b');
  spng_text text{};
  std::strcpy(text.keyword, "Comment");
  text.type = SPNG_ZTXT;
  text.length = bomb.size();
  text.text = bomb.data();
  spng_ihdr header{};
  header.width = header.height = 4;
  header.bit_depth = 8;
  header.color_type = SPNG_COLOR_TYPE_GRAYSCALE;
  const std::vector<std::uint8_t> pixels(16);
  spng_ctx* encoder = spng_ctx_new(SPNG_CTX_ENCODER);
  spng_set_option(encoder, SPNG_ENCODE_TO_BUFFER, 1);
  spng_set_ihdr(encoder, &header);
  LONGS_EQUAL(0, spng_set_text(encoder, &text, 1));
  LONGS_EQUAL(0,
              spng_encode_image(encoder, pixels.data(), pixels.size(), SPNG_FMT_PNG, SPNG_ENCODE_FINALIZE));
  std::size_t size = 0;
  int status = 0;
  char* png = static_cast<char*>(spng_get_png_buffer(encoder, &size, &status));
  const auto file = folder.write("bomb.png", std::string{png, size});
  std::free(png);
  spng_ctx_free(encoder);
  CHECK(size < 100'000);
  FAILS_NAMING(Errc::BadFormat, "bomb.png", read_png(file));
}

TEST(GreyImage, PipesAndDevicesAreNoPictures) {
  const auto pipe = folder.path() / "pipe.png";
  LONGS_EQUAL(0, ::mkfifo(pipe.c_str(), 0600));
  FAILS_NAMING(Errc::FileUnreadable, "a regular file expected", read_png(pipe));
  FAILS_NAMING(Errc::FileUnreadable, "a regular file expected", read_png("/dev/zero"));
}

}  // namespace biteline::image
