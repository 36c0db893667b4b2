// SPDX-License-Identifier: MIT
#include "hal/timing/edge_grid.hpp"

#include <CppUTest/TestHarness.h>

#include <random>

namespace biteline::hal {
namespace {

using namespace std::chrono_literals;

SensorClock::time_point at(Nanoseconds since_start) {
  return SensorClock::time_point{5s} + since_start;
}

TEST_GROUP(EdgeGrid) {
  EdgeGrid sut{{.period = 10ms, .tolerance = 1ms}};
};

TEST(EdgeGrid, MissedDoubledAndLateEdgesAreToldApart) {
  struct Row {
    Nanoseconds stamp;
    EdgeVerdict expected;
  };
  constexpr EdgeVerdict k_on_time = EdgeVerdict::OnTime;
  const Row rows[] = {{0ms, k_on_time},
                      {10ms, k_on_time},
                      {12ms, EdgeVerdict::Doubled},
                      {20ms, k_on_time},
                      {50ms, EdgeVerdict::AfterMissed},
                      {63ms, EdgeVerdict::Late},
                      {70ms, k_on_time},
                      {77ms, EdgeVerdict::Late},  // early
                      {90ms, k_on_time}};
  for (const Row& row : rows) CHECK(row.expected == sut.on_edge(at(row.stamp)));
  CHECK_EQUAL(2, sut.health().missed);
  CHECK_EQUAL(1, sut.health().doubled);
  CHECK_EQUAL(2, sut.health().late);
  CHECK_EQUAL(9, sut.slot());
}

TEST(EdgeGrid, CountsExactlyWhatARandomTrainLostAndDoubled) {
  std::mt19937 random{3};
  std::uint64_t missed = 0;
  std::uint64_t doubled = 0;
  for (int slot = 0; slot < 5000; ++slot) {
    const Nanoseconds jitter{static_cast<int>(random() % 400'000) - 200'000};
    const bool last = slot == 4999;  // what is missing at the end nobody can know
    if (slot > 0 && !last && random() % 20 == 0) {
      ++missed;
      continue;
    }
    sut.on_edge(at(slot * 10ms + jitter));
    if (!last && random() % 20 == 0) {
      ++doubled;
      sut.on_edge(at(slot * 10ms + jitter + 1ms));
    }
  }
  CHECK_EQUAL(missed, sut.health().missed);
  CHECK_EQUAL(doubled, sut.health().doubled);
  CHECK_EQUAL(0, sut.health().late);
}

TEST(EdgeGrid, DriftBetweenTheClocksIsFollowed) {
  for (int slot = 0; slot < 100'000; ++slot)
    sut.on_edge(at(slot * 10'001'000ns));  // 100 ppm: 10 periods in all
  CHECK_EQUAL(0, sut.health().late + sut.health().missed + sut.health().doubled);
}

}  // namespace
}  // namespace biteline::hal
