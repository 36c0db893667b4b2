// SPDX-License-Identifier: MIT
#include "common/recording/picture.hpp"

#include <CppUTest/TestHarness.h>

#include "tests/support/errors.hpp"

namespace biteline::recording {

TEST_GROUP(RecordingPicture) {
  std::vector<std::uint8_t> file{0x89, 'P', 'N', 'G', 1};
};

// The bytes by the rules of CDR: numbers on multiples of four behind the head, texts with a zero at their
// end.
TEST(RecordingPicture, HasTheBytesOfCompressedImage) {
  const std::vector<std::uint8_t> expected{0,    1,   0,   0,                           // little-endian
                                           2,    0,   0,   0,   5,   0,   0,   0,       // 2 s, 5 ns
                                           5,    0,   0,   0,   'c', 'a', 'm', '0', 0,  // frame_id
                                           0,    0,   0,                           // to a multiple of four
                                           4,    0,   0,   0,   'p', 'n', 'g', 0,  // format
                                           5,    0,   0,   0,                      // data
                                           0x89, 'P', 'N', 'G', 1};
  CHECK(expected == picture_message(2'000'000'005, file));
}

TEST(RecordingPicture, StampBeforeZeroHasNanosecondsAfterItsSecond) {
  const auto message = picture_message(-1, file);
  const std::vector<std::uint8_t> stamp(message.begin() + 4, message.begin() + 12);
  CHECK((std::vector<std::uint8_t>{0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xC9, 0x9A, 0x3B}) == stamp);
}

TEST(RecordingPicture, FileComesOutAgainAndACutMessageIsRefused) {
  const auto message = picture_message(7, file);
  const auto whole = picture_file_of(message);
  SUCCEEDS(whole);
  CHECK(std::vector<std::uint8_t>(whole->begin(), whole->end()) == file);
  for (std::size_t size = 0; size < message.size(); ++size)
    FAILS_NAMING(Errc::BadFormat, "picture", picture_file_of(std::span{message}.first(size)));
}

TEST(RecordingPicture, AnotherFormatIsNamed) {
  auto message = picture_message(7, file);
  message[28] = 'j';
  FAILS_NAMING(Errc::NotSupported, "png", picture_file_of(message));
}

}  // namespace biteline::recording
