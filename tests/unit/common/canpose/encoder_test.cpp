// SPDX-License-Identifier: MIT
#include "common/canpose/encoder.hpp"

#include <CppUTest/TestHarness.h>

#include <array>
#include <random>

namespace biteline::canpose {
namespace {

TEST_GROUP(PositionUnwrapper){};

TEST(PositionUnwrapper, FollowsASeededWalkThroughManyTurns) {
  constexpr std::uint32_t k_range_ticks = 8192;
  PositionUnwrapper sut{k_range_ticks};
  std::mt19937 random{1};
  std::int64_t truth_ticks = 100;
  CHECK(sut.feed(100) == 0);
  for (int i = 0; i < 5000; ++i) {
    truth_ticks += static_cast<std::int64_t>(random() % 3000) - 1000;
    const std::int64_t wrapped = ((truth_ticks % k_range_ticks) + k_range_ticks) % k_range_ticks;
    CHECK(sut.feed(static_cast<std::uint32_t>(wrapped)) == truth_ticks - 100);
  }
  CHECK_EQUAL(0, sut.refused());
}

TEST(PositionUnwrapper, AllThirtyTwoBitsWrap) {
  PositionUnwrapper sut{0};
  sut.feed(0xFFFFFFFEU);
  CHECK(sut.feed(3) == 5);
}

TEST(PositionUnwrapper, OneWildValueIsRefusedAndTheNextGoesOn) {
  PositionUnwrapper sut{1000};
  sut.feed(10);
  CHECK_FALSE(sut.feed(500).has_value());
  CHECK(sut.feed(12) == 2);
  CHECK_EQUAL(1, sut.refused());
}

TEST(PositionUnwrapper, ValueBeyondTheRangeIsNeverBelieved) {
  PositionUnwrapper sut{1000};
  sut.feed(10);
  CHECK_FALSE(sut.feed(1000).has_value());
  CHECK_FALSE(sut.feed(0xFFFFFFFFU).has_value());
  CHECK_EQUAL(2, sut.refused());
}

TEST(PositionUnwrapper, ShortObjectIsRefused) {
  const std::array<std::uint8_t, 5> data{0x78, 0x56, 0x34, 0x12, 0xFF};
  CHECK(decode_position(data).value() == 0x12345678U);
  CHECK_FALSE(decode_position(std::span{data}.first(3)).has_value());
}

}  // namespace
}  // namespace biteline::canpose
