// SPDX-License-Identifier: MIT
#include "host/interfaces/line_control/line_state.hpp"

#include <CppUTest/TestHarness.h>

#include <array>
#include <cmath>
#include <fstream>
#include <iterator>
#include <string>

namespace biteline::line_control {
namespace {

LineState full_state() {
  return {.step = Step::Following,
          .busy = true,
          .done = false,
          .job = 3,
          .taken = 17,
          .finished = 16,
          .verdict = Verdict::Amber,
          .model = 4,
          .sent = true,
          .followed = true,
          .scan = 70'001,
          .length_mm = 801.4,
          .u95_mm = 0.1234,
          .confidence = 0.9876,
          .counts = {.starts = 65'540, .ok = 5, .amber = 6, .refused = 7, .failed = 8, .review = 9},
          .part = "A-17",
          .next_part = "A-18"};
}

}  // namespace

TEST_GROUP(LineState){};

TEST(LineState, ValuesStandAtTheirPlaces) {
  const auto values = values_of(full_state(), 42, Refusal::Busy);
  constexpr std::array<std::uint16_t, k_values> k_expected{
      1, 42, 5, 0, 1, 0, 17, 16, 2, 3, 4, 1, 1, 3, 70'001 - 65'536, 4, 5, 6, 7, 8, 801, 123, 988, 9};
  for (std::size_t i = 0; i < k_values; ++i)
    LONGS_EQUAL_TEXT(k_expected.at(i), values.at(i), value_rows()[i].name);
}

TEST(LineState, WhatIsNotKnownIsTold) {
  const auto values = values_of({}, 0, Refusal::None);
  LONGS_EQUAL(0, values[20]);
  LONGS_EQUAL(65535, values[21]);
  LineState far;
  far.u95_mm = 1e300;
  far.length_mm = std::nan("");
  LONGS_EQUAL(65535, values_of(far, 0, Refusal::None)[21]);
  LONGS_EQUAL(0, values_of(far, 0, Refusal::None)[20]);
}

TEST(LineState, GoesThroughJsonUnchanged) {
  const auto back = line_state_of(to_json(full_state()));
  CHECK(back.has_value());
  CHECK(values_of(*back, 1, Refusal::None) == values_of(full_state(), 1, Refusal::None));
  STRCMP_EQUAL("A-17", back->part.c_str());
  STRCMP_EQUAL("A-18", back->next_part.c_str());
}

TEST(LineState, AnythingElseIsNone) {
  CHECK(!line_state_of(control::Json{}));
  CHECK(!line_state_of(control::Json::array()));
  const control::Json sound = to_json(full_state());
  for (const auto& field : sound.items()) {
    if (field.value().is_number_float()) continue;
    control::Json spoiled = sound;
    spoiled[field.key()] = field.value().is_string() ? control::Json("a\tb") : control::Json("x");
    CHECK_TEXT(!line_state_of(spoiled), field.key().c_str());
  }
  control::Json far = to_json(full_state());
  far["step"] = 8;
  CHECK(!line_state_of(far));
}

TEST(LineState, DocumentNamesEveryValueAtItsPlace) {
  std::ifstream file{BITELINE_DOCUMENTS "/line-control.md"};
  const std::string text{std::istreambuf_iterator<char>{file}, {}};
  for (std::size_t i = 0; i < k_values; ++i) {
    const std::string row =
        "| " + std::to_string(i) + " | `" + value_rows()[i].name + "` | " + value_rows()[i].words + " |";
    CHECK_TEXT(text.find(row) != std::string::npos, row.c_str());
  }
  for (int i = 0; i <= static_cast<int>(Refusal::BadRequest); ++i) {
    const std::string row = "| " + std::to_string(i) + " | " + words_of(static_cast<Refusal>(i)) + " |";
    CHECK_TEXT(text.find(row) != std::string::npos, row.c_str());
  }
}

}  // namespace biteline::line_control
