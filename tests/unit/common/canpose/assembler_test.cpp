// SPDX-License-Identifier: MIT
#include "common/canpose/assembler.hpp"

#include <CppUTest/TestHarness.h>

#include <random>

namespace biteline::canpose {
namespace {

SensorClock::time_point at_us(std::int64_t us) {
  return SensorClock::time_point{Nanoseconds{us * 1000}};
}

struct Sender {
  Assembler& sut;
  std::int64_t now_us{0};

  void sync(std::uint8_t counter) {
    const std::array data{counter};
    CHECK_FALSE(sut.feed(k_sync_id, data, at_us(now_us)).has_value());
  }
  std::optional<AssembledPose> frame(const PoseMessage& pose, std::size_t index) {
    return sut.feed(k_default_base_id + static_cast<std::uint32_t>(index),
                    encode_classic(pose).value()[index], at_us(now_us + 100));
  }
  std::optional<AssembledPose> classic(const PoseMessage& pose) {
    std::optional<AssembledPose> last;
    for (std::size_t i = 0; i < k_classic_frames; ++i) last = frame(pose, i);
    return last;
  }
  std::optional<AssembledPose> fd(const PoseMessage& pose) {
    return sut.feed(k_default_base_id + k_fd_id_offset, encode_fd(pose).value(), at_us(now_us + 100));
  }
};

PoseMessage numbered(std::uint8_t counter, std::uint64_t stamp_us = 0) {
  PoseMessage pose{.sync_counter = counter, .status = 0, .stamp_us = stamp_us};
  pose.T_base_flange.translation().x() = counter;
  return pose;
}

TEST_GROUP(Assembler) {
  Assembler sut;
  Sender sender{sut};
};

TEST(Assembler, PoseCarriesTheArrivalOfItsOwnSync) {
  sender.now_us = 5000;
  sender.sync(9);
  const std::optional<AssembledPose> pose = sender.classic(numbered(9, 77));
  CHECK(pose.has_value());
  CHECK(pose->latched == at_us(5000));
  CHECK(pose->stamp == RobotClock::time_point{Nanoseconds{77000}});
}

TEST(Assembler, PoseOfAnotherSyncHasNoLatchInstant) {
  sender.sync(9);
  sender.sync(10);
  const std::optional<AssembledPose> pose = sender.fd(numbered(9));
  CHECK(pose.has_value());
  CHECK_FALSE(pose->latched.has_value());
  CHECK_EQUAL(1, sut.health().poses_without_sync);
}

TEST(Assembler, LostFrameCostsOnePoseAndIsCountedOnce) {
  for (std::size_t lost = 0; lost < k_classic_frames; ++lost) {
    Assembler fresh;
    Sender to_fresh{fresh};
    for (std::uint8_t counter = 1; counter <= 3; ++counter) {
      for (std::size_t i = 0; i < k_classic_frames; ++i) {
        if (counter != 2 || i != lost) to_fresh.frame(numbered(counter), i);
      }
    }
    CHECK_EQUAL(2, fresh.health().poses);
    CHECK_EQUAL(1, fresh.health().poses_incomplete);
  }
}

TEST(Assembler, LostPoseIsAGapInTheSequence) {
  sender.classic(numbered(239));
  const std::optional<AssembledPose> pose = sender.classic(numbered(2));  // 240 and 1 are missing
  CHECK_EQUAL(4, pose->sequence);
}

TEST(Assembler, BothFormsOfOnePoseGiveItOnce) {
  CHECK(sender.classic(numbered(5)).has_value());
  CHECK_FALSE(sender.fd(numbered(5)).has_value());
  CHECK_EQUAL(1, sut.health().poses);
}

TEST(Assembler, ThirtyTwoBitStampGoesOnPastItsTurn) {
  const RobotClock::time_point before = sender.classic(numbered(1, 0xFFFFFF00U))->stamp;
  const RobotClock::time_point after = sender.classic(numbered(2, 0x00000100U))->stamp;
  CHECK_EQUAL(0x200 * 1000, (after - before).count());
}

TEST(Assembler, MissedSyncsAreCountedRoundTheTurn) {
  for (const std::uint8_t counter : {std::uint8_t{238}, std::uint8_t{239}, std::uint8_t{2}})
    sender.sync(counter);
  CHECK_EQUAL(3, sut.health().syncs);
  CHECK_EQUAL(2, sut.health().syncs_missed);
}

TEST(Assembler, SyncWithoutCounterIsRefused) {
  CHECK_FALSE(sut.feed(k_sync_id, {}, at_us(1)).has_value());
  CHECK_EQUAL(1, sut.health().frames_refused);
}

TEST(Assembler, NoiseNeverMakesAPoseAndNothingIsSilent) {
  std::mt19937 random{7};
  std::uint64_t own_frames = 0;
  for (int i = 0; i < 20000; ++i) {
    const std::uint32_t id = k_default_base_id + random() % 10;
    std::vector<std::uint8_t> data(random() % 65);
    for (std::uint8_t& byte : data) byte = static_cast<std::uint8_t>(random());
    if (id <= k_default_base_id + 3 || id == k_default_base_id + k_fd_id_offset) ++own_frames;
    CHECK_FALSE(sut.feed(id, data, at_us(i)).has_value());
  }
  CHECK(own_frames > 0);
  CHECK(sut.health().frames_refused + sut.health().poses_incomplete > own_frames / 2);
}

}  // namespace
}  // namespace biteline::canpose
