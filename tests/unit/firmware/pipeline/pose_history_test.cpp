// SPDX-License-Identifier: MIT
#include "firmware/pipeline/pose_history.hpp"

#include <CppUTest/TestHarness.h>

#include <cfenv>
#include <limits>

#include <memory>
#include <thread>

#include "tests/support/transforms.hpp"

namespace biteline::pipeline {
namespace {

SensorClock::time_point at_ms(std::int64_t time_ms) {
  return SensorClock::time_point{std::chrono::milliseconds{time_ms}};
}

/// Constant body velocity: all smoothing and interpolation is exact.
SE3 cruising(SensorClock::time_point time) {
  const double time_s = 1e-9 * static_cast<double>(time.time_since_epoch().count());
  return geometry::exp_se3((Twist{} << 200, -30, 10, 0.1, 0.4, -0.2).finished() * time_s);
}

}  // namespace

TEST_GROUP(PoseHistory) {
  std::unique_ptr<PoseHistory> sut = std::make_unique<PoseHistory>();

  void push(std::int64_t time_ms) {
    CHECK(sut->rt_push({.stamp = at_ms(time_ms), .T_base_flange = cruising(at_ms(time_ms))}));
  }
};

TEST(PoseHistory, FindsPosesAlsoAfterTheRingCameRound) {
  geometry::PoseEstimate pose;
  CHECK(!sut->rt_pose_at(at_ms(0), {}, pose));
  const auto capacity = static_cast<std::int64_t>(PoseHistory::k_capacity);
  for (std::int64_t i = 0; i < 2 * capacity + 100; ++i) push(2 * i);
  const auto newest_ms = 2 * (2 * capacity + 99);
  for (const std::int64_t back_ms : {1, 7, 333, 4000, 8000}) {
    CHECK(sut->rt_pose_at(at_ms(newest_ms - back_ms), {}, pose));
    TRANSFORMS_EQUAL(cruising(at_ms(newest_ms - back_ms)), pose.T_base_flange, 1e-6, 1e-9);
    CHECK(!pose.extrapolated);
  }
  // Overwritten long ago: the answer is the oldest there is, and says so.
  CHECK(sut->rt_pose_at(at_ms(10), {}, pose));
  CHECK(pose.stale);
  CHECK(pose.extrapolated);
}

TEST(PoseHistory, CountsComeBackWhereThereAreAny) {
  for (int i = 0; i < 6; ++i) {
    geometry::PoseSample sample{.stamp = at_ms(2 * i), .T_base_flange = cruising(at_ms(2 * i))};
    if (i < 4) sample.encoder_ticks = -100 * i;
    CHECK(sut->rt_push(sample));
  }
  geometry::PoseEstimate pose;
  CHECK(sut->rt_pose_at(at_ms(5), {}, pose));
  CHECK(pose.encoder_ticks == -250);
  CHECK(sut->rt_pose_at(at_ms(7), {}, pose));
  CHECK(!pose.encoder_ticks);
}

TEST(PoseHistory, IsReadyWhenTheWindowIsComplete) {
  const geometry::PoseSmoothing smoothing{.samples_each_side = 4, .reach = std::chrono::milliseconds{50}};
  for (int i = 0; i < 10; ++i) push(2 * i);      // to 18 ms
  CHECK(sut->rt_covers(at_ms(12), smoothing));   // 12, 14, 16, 18
  CHECK(!sut->rt_covers(at_ms(13), smoothing));  // three only
  push(64);
  CHECK(sut->rt_covers(at_ms(13), smoothing));  // beyond reach
}

TEST(PoseHistory, StampThatDoesNotRiseIsDropped) {
  push(10);
  CHECK(!sut->rt_push({.stamp = at_ms(10)}));
  CHECK(!sut->rt_push({.stamp = at_ms(8)}));
  CHECK(at_ms(10) == sut->rt_newest());
}

TEST(PoseHistory, WhatIsNoPoseOfAnArmIsDropped) {
  push(0);
  constexpr double k_nan = std::numeric_limits<double>::quiet_NaN();
  for (const double bad : {k_nan, std::numeric_limits<double>::infinity(), 1e308, 1.01e5}) {
    geometry::PoseSample sample{.stamp = at_ms(2), .T_base_flange = cruising(at_ms(2))};
    sample.T_base_flange.translation().y() = bad;
    CHECK(!sut->rt_push(sample));
    sample.T_base_flange = SE3::Identity();
    sample.T_base_flange.linear() *= bad;
    CHECK(!sut->rt_push(sample));
  }
  push(2);
  std::feclearexcept(FE_ALL_EXCEPT);  // raised on purpose
}

TEST(PoseHistory, ReadersMeetNoHalfWrittenPose) {
  std::atomic<bool> done{false};
  std::atomic<int> wrong{0}, found{0};
  std::thread reader{[&] {
    geometry::PoseEstimate pose;
    while (!done.load()) {
      const auto newest = sut->rt_newest();
      if (newest == SensorClock::time_point::min()) continue;
      const auto instant =
          newest - std::chrono::milliseconds{8000};  // where the writer is about to come round
      if (!sut->rt_pose_at(instant, {.samples_each_side = 4}, pose)) continue;
      if (pose.stale || pose.extrapolated) continue;
      ++found;
      const SE3 T_difference = cruising(instant).inverse() * pose.T_base_flange;
      if (T_difference.translation().norm() > 1e-5) ++wrong;
    }
  }};
  for (std::int64_t i = 0; i < 50000; ++i) {
    sut->rt_push({.stamp = at_ms(2 * i), .T_base_flange = cruising(at_ms(2 * i))});
    if (i % 4096 == 0) std::this_thread::yield();
  }
  done.store(true);
  reader.join();
  LONGS_EQUAL(0, wrong.load());
}

}  // namespace biteline::pipeline
