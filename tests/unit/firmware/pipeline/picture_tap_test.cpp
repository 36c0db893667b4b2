// SPDX-License-Identifier: MIT
#include "firmware/pipeline/picture_tap.hpp"

#include <CppUTest/TestHarness.h>

#include <memory>
#include <numeric>

namespace biteline::pipeline {

TEST_GROUP(PictureTap) {
  geometry::Region region{.offset_u_px = 0, .offset_v_px = 0, .width_px = 4, .height_px = 3};
  PictureTap sut{region};
  std::vector<std::uint8_t> padded = std::vector<std::uint8_t>(3 * 8);  // rows of 4 with 4 bytes of padding
  std::unique_ptr<profile::ProfileBuffer> profile = std::make_unique<profile::ProfileBuffer>();

  void setup() override {
    std::iota(padded.begin(), padded.end(), std::uint8_t{1});
    profile->header.sequence = 7;
    profile->count = 2;
    profile->points[1].column = 3;
    profile->points[1].row_px = 1.5F;
    profile->points[1].flags = profile::k_point_reflection;
  }
  hal::FrameView frame(int rows, int first_row, std::uint64_t sequence) const {
    return {.pixels = padded,
            .width_px = 4,
            .height_px = rows,
            .first_row_px = first_row,
            .stride_bytes = 8,
            .sequence = sequence,
            .exposure_mid = SensorClock::time_point{Nanoseconds{55}}};
  }
};

TEST(PictureTap, CopiesFrameWithoutPaddingAndThePeaks) {
  CHECK(!sut.rt_wanted());
  sut.rt_want();
  CHECK(sut.rt_wanted());
  sut.rt_keep_peaks(*profile);
  POINTERS_EQUAL(nullptr, sut.rt_take());
  sut.rt_keep_frame(frame(2, 1, 9));
  CHECK(!sut.rt_wanted());
  const TappedPicture* picture = sut.rt_take();
  CHECK(picture != nullptr);
  LONGS_EQUAL(9, picture->frame_sequence);
  LONGS_EQUAL(7, picture->profile_sequence);
  LONGS_EQUAL(2, picture->height_px);
  LONGS_EQUAL(1, picture->first_row_px);
  const std::uint8_t expected[] = {1, 2, 3, 4, 9, 10, 11, 12};
  MEMCMP_EQUAL(expected, picture->pixels.data(), sizeof expected);
  LONGS_EQUAL(2, picture->peak_count);
  LONGS_EQUAL(3, picture->peaks[1].column);
  DOUBLES_EQUAL(1.5, picture->peaks[1].row_px, 0);
  LONGS_EQUAL(profile::k_point_reflection, picture->peaks[1].flags);
}

TEST(PictureTap, FullProfileFits) {
  profile->count = profile->points.size();
  sut.rt_keep_peaks(*profile);
  sut.rt_keep_frame(frame(3, 0, 1));
  LONGS_EQUAL(profile->points.size(), sut.rt_take()->peak_count);
}

}  // namespace biteline::pipeline
