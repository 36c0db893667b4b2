// SPDX-License-Identifier: MIT
/// \file The Aravis backend on a network that loses and garbles packets.
#include <CppUTest/TestHarness.h>

#include "hal/linux/aravis/aravis_camera.hpp"
#include "hal/sim/gvcamera/lossy_line.hpp"
#include "tests/hal/aravis/small_camera.hpp"
#include "tests/support/fuzz.hpp"
#include "tests/support/timed_test.hpp"

namespace biteline::hal {

TEST_GROUP(LostPackets){};

TIMED_TEST(LostPackets, LostPacketsGiveDamagedFramesAndGapsThatAreCounted) {
  GvCamera::Config config = small_camera();
  config.lost_packet_ratio = 0.004;  // 640 x 120 in packets of 1400 bytes: one frame in five
  SERVER_OR_SKIP(server, config);
  auto sut = *AravisCamera::open({.packet_bytes = 1400});
  CHECK(sut->configure(settings(200)).has_value());
  CHECK(sut->start().has_value());
  std::uint64_t flagged = 0, whole = 0, last_sequence = 0;
  for (int i = 0; i < 120; ++i) {
    const auto frame = sut->next_frame(2 * k_second);
    CHECK(frame.has_value());
    (frame->flags & k_frame_damaged) != 0 ? ++flagged : ++whole;
    last_sequence = frame->sequence;
    sut->release(*frame);
  }
  CHECK(sut->stop().has_value());
  const CameraHealth health = sut->health();
  CHECK(flagged + health.frames_lost > 2);
  LONGS_EQUAL(flagged, health.frames_damaged);
  LONGS_EQUAL(whole, health.frames);
  // Every frame of the camera's own count is accounted for.
  LONGS_EQUAL(last_sequence + 1, health.frames + health.frames_damaged + health.frames_lost);
}

// Aravis leaves the former frame's number and stamp in a buffer whose leader is lost.
TIMED_TEST(LostPackets, AFrameWithoutItsLeaderIsNeverGivenAnothersNumberAndTime) {
  GvCamera::Config config = small_camera();
  config.lost_packet_ratio = 0.02;  // 58 packets a frame: two frames in three, one leader in fifty
  SERVER_OR_SKIP(server, config);
  auto sut = *AravisCamera::open({.packet_bytes = 1400});
  CHECK(sut->configure(settings(200)).has_value());
  CHECK(sut->start().has_value());
  std::uint64_t last_sequence = 0;
  auto last_mid = SensorClock::time_point::min();
  for (int i = 0; i < 400; ++i) {
    const auto frame = sut->next_frame(2 * k_second);
    CHECK(frame.has_value());
    CHECK(frame->exposure_mid > last_mid);
    last_mid = frame->exposure_mid;
    last_sequence = frame->sequence;
    sut->release(*frame);
  }
  CHECK(sut->stop().has_value());
  const CameraHealth health = sut->health();
  CHECK(health.frames_lost > 0);
  CHECK(last_sequence < server->exposures());
  // Frames with holes are given out from the first on: a hole is some thirty times as likely as a lost
  // leader.
  CHECK(health.frames_damaged > 5 * health.frames_lost);
}

TIMED_TEST(LostPackets, FramesLostBeforeTheFirstOneAreCounted) {
  SERVER_OR_SKIP(server, small_camera());
  const auto line = *sim::LossyLine::open({.lost_ratio = 0, .leaders_to_lose = 3});
  auto sut = *AravisCamera::open({.address = "127.0.0.2", .packet_bytes = 1400});
  CHECK(sut->configure(settings(100)).has_value());
  CHECK(sut->start().has_value());
  for (std::uint64_t number = 3; number < 30; ++number) {
    const auto frame = sut->next_frame(2 * k_second);
    CHECK(frame.has_value());
    LONGS_EQUAL(number, frame->sequence);
    LONGS_EQUAL(number == 3, (frame->flags & k_frame_gap_before) != 0);
    sut->release(*frame);
  }
  LONGS_EQUAL(3, line->packets_lost());
  LONGS_EQUAL(3, sut->health().frames_lost);
  LONGS_EQUAL(0, sut->health().frames_damaged);
}

TIMED_TEST(LostPackets, LostPacketsAreAskedForAgainAndTheFrameIsWhole) {
  GvCamera::Config config = small_camera();
  config.resends = true;
  SERVER_OR_SKIP(server, config);
  const auto line = *sim::LossyLine::open({.lost_ratio = 0.01});
  auto sut = *AravisCamera::open({.address = "127.0.0.2", .packet_bytes = 1400});
  CHECK(sut->configure(settings(50)).has_value());
  CHECK(sut->start().has_value());
  std::uint64_t whole = 0;
  for (int i = 0; i < 60; ++i) {
    const auto frame = sut->next_frame(2 * k_second);
    CHECK(frame.has_value());
    if ((frame->flags & k_frame_damaged) == 0) {
      ++whole;
      LONGS_EQUAL(77, frame->pixels[640 * 120 - 1]);
      LONGS_EQUAL(frame->pixels[0], frame->pixels[640 * 60]);
    }
    sut->release(*frame);
  }
  CHECK(sut->stop().has_value());
  // 57 packets in a frame: every second one lost a packet at first.
  CHECK(line->packets_lost() > 15);
  CHECK(line->packets_sent_again() > 0);
  CHECK(sut->health().packets_resent > 0);
  CHECK(whole > 50);
}

/// Headers, sizes, stamps and numbers of any value: every frame given out has the size that was asked for,
/// its pixels can be read, and good packets make good frames again.
TIMED_TEST(LostPackets, GarbledPacketsNeverHarm) {
  GvCamera::Config config = small_camera();
  config.resends = true;
  SERVER_OR_SKIP(server, config);
  std::uint64_t readable = 0, whole = 0;
  for (int round = 0; round < test::fuzz_factor(); ++round) {
    const auto line = *sim::LossyLine::open(
        {.lost_ratio = 0, .garbled_ratio = 0.01, .seed = static_cast<std::uint32_t>(round + 1)});
    auto sut = *AravisCamera::open({.address = "127.0.0.2", .packet_bytes = 1400});
    CHECK(sut->configure(settings(100)).has_value());
    CHECK(sut->start().has_value());
    for (int i = 0; i < 200; ++i) {
      const auto frame = sut->next_frame(Nanoseconds{100'000'000});
      if (!frame) {
        CHECK_EQUAL(static_cast<int>(Errc::Timeout), static_cast<int>(frame.error().code));
        continue;
      }
      LONGS_EQUAL(640 * 120, frame->pixels.size());
      LONGS_EQUAL(640, frame->width_px);
      for (const std::uint8_t pixel : frame->pixels) readable += pixel == 77 ? 1 : 0;
      whole += (frame->flags & k_frame_damaged) == 0 ? 1 : 0;
      sut->release(*frame);
    }
    CHECK(sut->stop().has_value());
  }
  CHECK(readable > 0);
  CHECK(whole > 20);
}

}  // namespace biteline::hal
