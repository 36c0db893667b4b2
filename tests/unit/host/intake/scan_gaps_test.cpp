// SPDX-License-Identifier: MIT
#include "host/intake/scan_gaps.hpp"

#include <CppUTest/TestHarness.h>

namespace biteline::intake {

TEST_GROUP(ScanGaps) {
  static constexpr std::int64_t k_period_ns = 10'000'000;
  ScanGaps sut;
  profile::ProfileHeader next;

  /// `count` profiles, one period apart.
  void add(int count) {
    for (int i = 0; i < count; ++i) {
      sut.add(next);
      ++next.sequence;
      ++next.frame_sequence;
      next.exposure_mid += Nanoseconds{k_period_ns};
      next.flags = 0;
    }
  }
};

TEST(ScanGaps, WholeScanHasNone) {
  add(200);
  const LongestGap gap = sut.longest();
  LONGS_EQUAL(0, gap.frames + gap.profiles + gap.edges);
}

TEST(ScanGaps, LongestOfSeveralCounts) {
  add(50);
  next.sequence += 2;
  add(50);
  next.sequence += 5;
  add(50);
  next.sequence += 1;
  add(50);
  LONGS_EQUAL(5, sut.longest().profiles);
}

TEST(ScanGaps, ProfilesBeforeTheFirstOneAreMissingToo) {
  next.sequence = 7;
  add(50);
  LONGS_EQUAL(7, sut.longest().profiles);
}

TEST(ScanGaps, FramesAreLostWhereTheSensorSaysSo) {
  add(50);
  next.frame_sequence += 3;
  next.flags = profile::k_profile_frame_gap;
  add(50);
  LONGS_EQUAL(3, sut.longest().frames);
}

TEST(ScanGaps, HoleThatNobodyCountedShowsInTheTime) {
  add(100);
  next.exposure_mid += Nanoseconds{800 * k_period_ns};  // the process stood for 8 s; all counters go on
  add(100);
  LONGS_EQUAL(800, sut.longest().edges);
}

TEST(ScanGaps, JitterIsNoHole) {
  for (int i = 0; i < 100; ++i) {
    next.exposure_mid += Nanoseconds{i % 2 == 0 ? k_period_ns / 4 : -k_period_ns / 4};
    add(1);
  }
  LONGS_EQUAL(0, sut.longest().edges);
}

TEST(ScanGaps, EveryFourthFrameDarkIsNoHole) {
  for (int i = 0; i < 50; ++i) {
    add(3);
    next.frame_sequence += 1;
    next.exposure_mid += Nanoseconds{k_period_ns};
  }
  const LongestGap gap = sut.longest();
  LONGS_EQUAL(0, gap.frames);
  CHECK(gap.edges <= 1);
}

TEST(ScanGaps, QuickerThanTheSettingForMostOfTheScanIsNoHole) {
  sut = ScanGaps{1e9 / (8.0 * k_period_ns)};
  add(100);
  for (int i = 0; i < 5; ++i) {  // searching, at the rate of the whole picture
    next.exposure_mid += Nanoseconds{7 * k_period_ns};
    add(1);
  }
  add(50);
  LONGS_EQUAL(0, sut.longest().edges);
}

TEST(ScanGaps, TooFewProfilesSayNothingByTime) {
  add(2);
  next.exposure_mid += Nanoseconds{50 * k_period_ns};
  add(2);
  LONGS_EQUAL(0, sut.longest().edges);
}

}  // namespace biteline::intake
