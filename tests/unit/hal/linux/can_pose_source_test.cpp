// SPDX-License-Identifier: MIT
#include "hal/linux/socketcan/can_pose_source.hpp"

#include <CppUTest/TestHarness.h>

#include <optional>
#include <random>

#include "tests/support/fuzz.hpp"
#include "tests/unit/hal/linux/fake_can_bus.hpp"

namespace biteline::hal {
namespace {

using namespace std::chrono_literals;

TEST_GROUP(CanPoseSource) {
  VirtualClock clock{SensorClock::time_point{10s}};
  FakeCanBus* bus = new FakeCanBus{clock};
  CanPoseSource sut{std::unique_ptr<CanBus>{bus}, clock, {.lost_after = 100ms}};

  void send_sync(std::uint8_t counter) {
    bus->put(canpose::k_sync_id, std::array{counter});
  }
  void send_pose(std::uint8_t counter, std::uint64_t stamp_us, std::uint8_t status = 0) {
    canpose::PoseMessage pose{.sync_counter = counter, .status = status, .stamp_us = stamp_us};
    pose.T_base_flange.translation().y() = counter;
    const canpose::ClassicFrames frames = canpose::encode_classic(pose).value();
    for (std::uint32_t i = 0; i < frames.size(); ++i) bus->put(canpose::k_default_base_id + i, frames[i]);
  }
};

TEST(CanPoseSource, GivesThePoseWithTheInstantOfItsSync) {
  CHECK(sut.start().has_value());
  send_sync(3);
  const SensorClock::time_point latched = clock.now();
  clock.advance(1ms);
  send_pose(3, 500, canpose::k_protective_stop | canpose::k_simulated);
  const Result<RobotPose> pose = sut.next_pose(10ms);
  CHECK(pose.has_value());
  CHECK(pose->stamp_sensor == latched);
  CHECK(pose->received == latched + 1ms);
  CHECK_EQUAL(k_pose_protective_stop | k_pose_simulated, pose->status);
  DOUBLES_EQUAL(3.0, pose->T_base_flange.translation().y(), 1e-4);
  CHECK(sut.health().state == PoseState::Streaming);
}

TEST(CanPoseSource, SyncWhoseInstantIsAGuessLatchesNothing) {
  CHECK(sut.start().has_value());
  send_sync(3);
  bus->queue.back().stamp_estimated = true;
  send_pose(3, 500);
  const Result<RobotPose> pose = sut.next_pose(10ms);
  CHECK(pose.has_value());
  CHECK_FALSE(pose->stamp_sensor.has_value());  // no clock map yet either
  CHECK_EQUAL(1, sut.health().poses_unlatched);
}

TEST(CanPoseSource, FollowsItsStateTable) {
  CHECK(sut.next_pose(1ms).error().code == Errc::WrongState);
  CHECK(sut.stop().has_value());
  CHECK(sut.start().has_value());
  CHECK(sut.start().error().code == Errc::WrongState);
  CHECK(sut.health().state == PoseState::Connecting);
  CHECK(sut.next_pose(1ms).error().code == Errc::Timeout);
  CHECK(sut.stop().has_value());
  CHECK(sut.health().state == PoseState::Idle);
}

TEST(CanPoseSource, SilenceIsLostAndItsEndIsAReconnect) {
  CHECK(sut.start().has_value());
  send_pose(1, 1000);
  CHECK(sut.next_pose(10ms).has_value());
  CHECK_FALSE(sut.next_pose(50ms).has_value());
  CHECK(sut.health().state == PoseState::Streaming);
  CHECK_FALSE(sut.next_pose(60ms).has_value());
  CHECK(sut.health().state == PoseState::Lost);
  send_pose(2, 2000);
  CHECK(sut.next_pose(10ms).has_value());
  CHECK(sut.health().state == PoseState::Streaming);
  CHECK_EQUAL(1, sut.health().reconnects);
}

TEST(CanPoseSource, MissingPosesAreCounted) {
  CHECK(sut.start().has_value());
  send_pose(1, 1000);
  send_pose(5, 5000);
  CHECK(sut.next_pose(10ms).has_value());
  CHECK(sut.next_pose(10ms).has_value());
  CHECK_EQUAL(3, sut.health().poses_lost);
}

TEST(CanPoseSource, StampThatDoesNotRiseIsRejected) {
  CHECK(sut.start().has_value());
  send_pose(1, 1000);
  send_pose(2, 1000);
  CHECK(sut.next_pose(10ms).has_value());
  CHECK_FALSE(sut.next_pose(10ms).has_value());
  CHECK_EQUAL(1, sut.health().poses_rejected);
}

TEST(CanPoseSource, InvalidPoseIsRejected) {
  CHECK(sut.start().has_value());
  send_pose(1, 1000, canpose::k_pose_invalid);
  CHECK_FALSE(sut.next_pose(10ms).has_value());
  CHECK_EQUAL(1, sut.health().poses_rejected);
}

TEST(CanPoseSource, ClockSetBackIsBelievedOnlyAfterItCountedAsLost) {
  CHECK(sut.start().has_value());
  send_pose(1, 1'000'000);
  CHECK(sut.next_pose(1ms).has_value());
  std::uint8_t counter = 2;
  std::uint64_t stamp_us = 10;
  int rejected = 0;
  while (sut.health().reconnects == 0 && rejected < 100) {
    send_pose(counter++, stamp_us += 8000);
    if (!sut.next_pose(8ms)) ++rejected;
  }
  CHECK(rejected > 100 / 8);  // lost_after of silence at one pose each 8 ms
  CHECK(rejected < 20);
  CHECK(sut.health().state == PoseState::Streaming);
}

TEST(CanPoseSource, ForeignTrafficNeitherBlocksNorHidesSilence) {
  CHECK(sut.start().has_value());
  send_pose(1, 1000);
  CHECK(sut.next_pose(10ms).has_value());
  clock.advance(200ms);
  send_sync(2);  // passes the filter, is no pose
  CHECK(sut.next_pose(0ms).error().code == Errc::Timeout);
  CHECK(sut.health().state == PoseState::Lost);
}

/// Frames of every kind in any order, also with true check sums: what is given out is a pose, later than the
/// one before.
TEST(CanPoseSource, WhateverIsOnTheBusOnlyPosesComeOut) {
  std::mt19937_64 random{3};
  CHECK(sut.start().has_value());
  std::uint64_t given = 0;
  std::optional<RobotClock::time_point> last;
  for (int round = 0; round < 20000 * test::fuzz_factor(); ++round) {
    std::array<std::uint8_t, canpose::k_fd_size_bytes> data{};
    const auto fill = [&](std::size_t size) {
      for (std::size_t i = 0; i < size; ++i)
        data[i] = static_cast<std::uint8_t>(random() % 3 == 0 ? 0xFF * (random() % 2) : random());
      return std::span{data}.first(size);
    };
    const auto counter = static_cast<std::uint8_t>(1 + round % 4 == 0 ? random() : random() % 241);
    switch (random() % 5) {
      case 0:
        bus->put(canpose::k_sync_id, fill(random() % 3));
        break;
      case 1:
        send_sync(counter);
        break;
      case 2:
        bus->put(canpose::k_default_base_id + static_cast<std::uint32_t>(random() % 9), fill(random() % 9));
        break;
      case 3: {
        // Every number wild, the check sum right.
        fill(data.size());
        data[0] = canpose::k_fd_layout_version;
        data[1] = counter;
        if (random() % 2 == 0) {
          std::fill(data.begin() + 24, data.begin() + 40, std::uint8_t{0});
          data[27 - 4 * (random() % 1)] = 0x40;  // w = 1
        }
        const std::uint16_t crc = canpose::crc16(std::span{data}.first(46));
        data[46] = static_cast<std::uint8_t>(crc & 0xFFU);
        data[47] = static_cast<std::uint8_t>(crc >> 8U);
        bus->put(canpose::k_default_base_id + canpose::k_fd_id_offset, data);
        break;
      }
      default:
        send_pose(static_cast<std::uint8_t>(1 + random() % 240),
                  random() % 2 == 0 ? random() : static_cast<std::uint64_t>(round) * 1000);
        break;
    }
    const Result<RobotPose> pose =
        sut.next_pose(Nanoseconds{static_cast<std::int64_t>(random() % 2'000'000)});
    if (!pose) continue;
    ++given;
    CHECK(pose->T_base_flange.matrix().allFinite());
    DOUBLES_EQUAL(1, pose->T_base_flange.linear().determinant(), 1e-6);
    // Only a source that was lost may begin anew.
    if (last && pose->stamp <= *last) CHECK(sut.health().reconnects > 0);
    last = pose->stamp;
  }
  CHECK(given > 100);
}

}  // namespace
}  // namespace biteline::hal
