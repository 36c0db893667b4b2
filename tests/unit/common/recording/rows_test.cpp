// SPDX-License-Identifier: MIT
#include "common/recording/rows.hpp"

#include <CppUTest/TestHarness.h>

#include <cstring>

#include "tests/support/errors.hpp"

namespace biteline::recording {

TEST_GROUP(RecordingRows){static std::span<const std::uint8_t> view(const std::string& text){
    return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}
}
;

TEST(RecordingRows, PoseKeepsEveryBit) {
  const PoseRow row{.stamp_ns = -1'700'000'000'123'456'789,
                    .values = {1.0 / 3, -200.0 / 7, 1e-300, 0.1, 0.2, 0.49999999999999994, -0.0}};
  const std::string message = message_of(row);
  const auto again = pose_row_of(view(message));
  SUCCEEDS(again);
  LONGS_EQUAL(row.stamp_ns, again->stamp_ns);
  CHECK(std::memcmp(row.values.data(), again->values.data(), sizeof row.values) == 0);
  CHECK(!again->encoder_ticks);
}

TEST(RecordingRows, AnEncodersCountIsInThePosesMessageWhereThereIsOne) {
  const std::string message = message_of(PoseRow{.stamp_ns = 1, .encoder_ticks = -0x1f'ffff'ffff'ffff});
  CHECK(pose_row_of(view(message))->encoder_ticks == -0x1f'ffff'ffff'ffff);
  const std::string half = R"({"stamp_ns":1,"p_mm":[1,2,3],"q_wxyz":[1,0,0,0],"encoder_ticks":0.5})";
  FAILS_NAMING(Errc::BadValue, "encoder_ticks: a whole number", pose_row_of(view(half)));
}

TEST(RecordingRows, FrameIsReadAsItWasSaid) {
  const FrameRow row{
      .stamp_ns = 5,
      .file = "5.png",
      .facts = FrameRow::Facts{.sequence = 1ULL << 63U, .flags = 16, .first_row_px = 3, .rows_px = 9}};
  const std::string message = message_of(row);
  const auto again = frame_row_of(view(message));
  SUCCEEDS(again);
  STRCMP_EQUAL("5.png", again->file.c_str());
  CHECK(again->facts.has_value());
  LONGS_EQUAL(row.facts->sequence, again->facts->sequence);
  LONGS_EQUAL(9, again->facts->rows_px);
}

TEST(RecordingRows, NameThatLeadsElsewhereIsRefused) {
  for (const char* name : {"../a.png", "/a.png", "", ".", "..", "a/b.png", "a,b.png", "a\\nb.png"}) {
    const std::string message = std::string{R"({"stamp_ns":1,"file":")"} + name + "\"}";
    FAILS_NAMING(Errc::BadValue, "plain file name", frame_row_of(view(message)));
  }
}

TEST(RecordingRows, WhatIsNoRowIsRefused) {
  const std::pair<const char*, const char*> cases[] = {
      {"{", "JSON object"},
      {"[1]", "JSON object"},
      {R"({"stamp_ns":1.5,"p_mm":[1,2,3],"q_wxyz":[1,0,0,0]})", "stamp_ns"},
      {R"({"stamp_ns":1,"p_mm":[1,2],"q_wxyz":[1,0,0,0]})", "p_mm"},
      {R"({"stamp_ns":1,"p_mm":[1,2,"3"],"q_wxyz":[1,0,0,0]})", "p_mm"},
      {R"({"stamp_ns":1,"p_mm":[1,2,3]})", "q_wxyz"}};
  for (const auto& [text, place] : cases) {
    const auto row = pose_row_of(view(text));
    CHECK(!row.has_value());
    STRCMP_CONTAINS(place, to_line(row.error()).c_str());
  }
  FAILS_NAMING(Errc::BadValue, "flags",
               frame_row_of(view(R"({"stamp_ns":1,"file":"a","sequence":1,"flags":4294967296})")));
}

}  // namespace biteline::recording
