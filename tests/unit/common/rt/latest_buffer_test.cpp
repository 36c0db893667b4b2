// SPDX-License-Identifier: MIT
#include "common/rt/latest_buffer.hpp"

#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <atomic>
#include <thread>
#include <vector>

namespace biteline::rt {

TEST_GROUP(LatestBuffer){};

TEST(LatestBuffer, GivesTheNewestOnceAndNothingTwice) {
  LatestBuffer<int> sut;
  POINTERS_EQUAL(nullptr, sut.rt_take());
  for (int i = 1; i <= 3; ++i) {
    sut.rt_back() = i;
    sut.rt_publish();
  }
  LONGS_EQUAL(3, *sut.rt_take());
  POINTERS_EQUAL(nullptr, sut.rt_take());
}

TEST(LatestBuffer, WhatTheReaderHoldsIsNotWrittenOver) {
  LatestBuffer<int> sut;
  sut.rt_back() = 1;
  sut.rt_publish();
  const int* held = sut.rt_take();
  for (int i = 2; i < 20; ++i) {
    sut.rt_back() = i;
    sut.rt_publish();
  }
  LONGS_EQUAL(1, *held);
  LONGS_EQUAL(19, *sut.rt_take());
}

/// Two threads over large values: a reader never sees a half-written one, and never an older one after a
/// newer.
TEST(LatestBuffer, ReaderSeesWholeValuesInOrder) {
  constexpr std::uint32_t k_last = 20000;
  LatestBuffer<std::vector<std::uint32_t>> sut{std::vector<std::uint32_t>(64)};
  std::thread writer{[&] {
    for (std::uint32_t i = 1; i <= k_last; ++i) {
      std::ranges::fill(sut.rt_back(), i);
      sut.rt_publish();
      if (i % 64 == 0) std::this_thread::yield();
    }
  }};
  std::uint32_t newest = 0;
  int torn = 0, backwards = 0;
  while (newest != k_last) {
    const std::vector<std::uint32_t>* taken = sut.rt_take();
    if (taken == nullptr) {
      std::this_thread::yield();
      continue;
    }
    if (std::ranges::count(*taken, taken->front()) != 64) ++torn;
    if (taken->front() <= newest) ++backwards;
    newest = taken->front();
  }
  writer.join();
  LONGS_EQUAL(0, torn);
  LONGS_EQUAL(0, backwards);
}

}  // namespace biteline::rt
