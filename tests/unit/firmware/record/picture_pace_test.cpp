// SPDX-License-Identifier: MIT
#include "firmware/record/picture_pace.hpp"

#include <CppUTest/TestHarness.h>

#include <chrono>

namespace biteline::record {

using std::chrono::milliseconds;

TEST_GROUP(PicturePace) {
  PicturePace sut;
  static constexpr milliseconds k_in_time{20}, k_late{200};

  /// Of so many late pictures, those that were packed.
  int packed_of(int count, milliseconds packing, milliseconds storing) {
    int all = 0;
    for (int i = 0; i < count; ++i) {
      const bool packed = sut.packed(k_late);
      sut.note(packed, packed ? packing : storing);
      all += packed ? 1 : 0;
    }
    return all;
  }
};

TEST(PicturePace, PicturesInTimeArePacked) {
  for (int i = 0; i < 200; ++i) {
    CHECK(sut.packed(k_in_time));
    sut.note(true, milliseconds{30});
  }
}

TEST(PicturePace, LatePicturesTakeTheQuickerWay) {
  // Once each to know it, and each 64th to see whether it is still so.
  LONGS_EQUAL(1 + 3, packed_of(200, milliseconds{30}, milliseconds{5}));
}

TEST(PicturePace, DiskThatGetsSlowIsNoticed) {
  packed_of(200, milliseconds{30}, milliseconds{5});
  CHECK(packed_of(200, milliseconds{30}, milliseconds{90}) > 180);
}

}  // namespace biteline::record
