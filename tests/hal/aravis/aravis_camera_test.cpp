// SPDX-License-Identifier: MIT
/// \file The Aravis backend against Aravis' own fake camera: real GigE Vision packets over loopback.
#include "hal/linux/aravis/aravis_camera.hpp"

#include <CppUTest/TestHarness.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <thread>

#include "tests/hal/aravis/small_camera.hpp"
#include "tests/support/timed_test.hpp"

namespace biteline::hal {

namespace {

/// What the camera was set to when it exposed: 10 us units of exposure, strobe, first row.
void paint_settings(const GvExposure& exposure, std::span<std::uint8_t> pixels) {
  pixels[0] = static_cast<std::uint8_t>(exposure.exposure.count() / 10'000);
  pixels[1] = exposure.strobe ? 1 : 0;
  pixels[2] = static_cast<std::uint8_t>(exposure.region.offset_v_px);
  pixels[pixels.size() - 1] = 77;
}

/// Triggered, so that the middle of each exposure is known: edge + half of what the picture says of it.
struct TriggeredFrame {
  FrameView frame;
  int exposure_10us{0};
  bool strobe{false};
  int offset_v_px{0};
};
TriggeredFrame triggered_frame(GvCamera& server, AravisCamera& camera) {
  const auto edge = now();
  server.trigger(edge);
  const auto frame = camera.next_frame(k_second);
  CHECK(frame.has_value());
  const TriggeredFrame out{*frame, frame->pixels[0], frame->pixels[1] != 0, frame->pixels[2]};
  LONGS_EQUAL((edge + Nanoseconds{out.exposure_10us * 5'000}).time_since_epoch().count(),
              frame->exposure_mid.time_since_epoch().count());
  LONGS_EQUAL(77, frame->pixels.back());
  camera.release(*frame);
  return out;
}
CameraSettings triggered_settings() {
  CameraSettings triggered = settings(100);
  triggered.trigger = Trigger::Hardware;
  return triggered;
}

}  // namespace

TEST_GROUP(AravisCamera){};

// Two servers at one port would each get some of the other's packets.
TEST(AravisCamera, ASecondServerAtTheSameAddressIsRefused) {
  SERVER_OR_SKIP(server, small_camera());
  const auto second = GvCamera::open(small_camera(), paint_number);
  CHECK_FALSE(second.has_value());
  CHECK_EQUAL(static_cast<int>(Errc::ConnectFailed), static_cast<int>(second.error().code));
}

TEST(AravisCamera, ASecondProgramIsToldWhoHasTheCameraAndGetsItAfterwards) {
  SERVER_OR_SKIP(server, small_camera());
  auto first = *AravisCamera::open({});
  const auto second = AravisCamera::open({});
  CHECK_FALSE(second.has_value());
  STRCMP_CONTAINS("camera 127.0.0.1: another program controls it", second.error().where.c_str());
  STRCMP_CONTAINS("3.0 s", second.error().where.c_str());
  first.reset();
  CHECK(AravisCamera::open({}).has_value());
}

TEST(AravisCamera, RefusesCallsOutOfOrder) {
  SERVER_OR_SKIP(server, small_camera());
  auto sut = *AravisCamera::open({});
  CHECK_EQUAL(static_cast<int>(Errc::WrongState), static_cast<int>(sut->start().error().code));
  CHECK_EQUAL(static_cast<int>(Errc::WrongState), static_cast<int>(sut->next_frame(k_second).error().code));
  CHECK(sut->stop().has_value());
  CHECK(sut->configure(settings(50)).has_value());
  CHECK_EQUAL(static_cast<int>(Errc::WrongState), static_cast<int>(sut->next_frame(k_second).error().code));
  CHECK(sut->start().has_value());
  CHECK_EQUAL(static_cast<int>(Errc::WrongState),
              static_cast<int>(sut->configure(settings(50)).error().code));
  CHECK_EQUAL(static_cast<int>(Errc::WrongState), static_cast<int>(sut->start().error().code));
  CHECK(sut->stop().has_value());
  CHECK(sut->stop().has_value());
}

TEST(AravisCamera, TellsWhatTheCameraIsAndRefusesWhatItCannot) {
  SERVER_OR_SKIP(server, small_camera());
  auto sut = *AravisCamera::open({});
  const auto limits = *sut->limits();
  LONGS_EQUAL(1626, limits.sensor_width_px);
  LONGS_EQUAL(1236, limits.sensor_height_px);
  CHECK(limits.hardware_trigger);
  CHECK(limits.bracketing);
  CameraSettings outside = settings(50);
  outside.region.offset_v_px = 1200;
  CHECK_EQUAL(static_cast<int>(Errc::BadValue), static_cast<int>(sut->configure(outside).error().code));
  CameraSettings both = settings(50);
  both.second_exposure = Nanoseconds{1'000'000};
  both.laser_off_frames = true;
  CHECK_EQUAL(static_cast<int>(Errc::InvalidArgument), static_cast<int>(sut->configure(both).error().code));
  DOUBLES_EQUAL(41.5, sut->health().temperature_degc, 0.01);
}

TIMED_TEST(AravisCamera, FreeRunGivesEveryFrameOfTheRegionInOrder) {
  SERVER_OR_SKIP(server, small_camera());
  auto sut = *AravisCamera::open({.packet_bytes = 8000});
  const auto got = *sut->configure(settings(200));
  LONGS_EQUAL(100, got.region.offset_v_px);
  DOUBLES_EQUAL(200, got.rate_hz, 1);
  CHECK(sut->start().has_value());
  // A busy machine delays packets beyond what a frame may wait for them: said and counted, never hidden.
  std::uint64_t expected = 0, damaged = 0, lost = 0;
  SensorClock::time_point last{};
  for (int i = 0; i < 60; ++i) {
    const auto frame = sut->next_frame(k_second);
    CHECK(frame.has_value());
    LONGS_EQUAL(640, frame->width_px);
    LONGS_EQUAL(120, frame->height_px);
    CHECK(frame->sequence >= expected);
    LONGS_EQUAL(frame->sequence > expected, (frame->flags & k_frame_gap_before) != 0);
    lost += frame->sequence - expected;
    expected = frame->sequence;
    if ((frame->flags & k_frame_damaged) != 0) {
      ++damaged;
    } else {
      LONGS_EQUAL(0, frame->flags & ~std::uint32_t{k_frame_gap_before});
      LONGS_EQUAL(expected % 251, frame->pixels[0]);
      LONGS_EQUAL(100, frame->pixels[1]);
      LONGS_EQUAL(77, frame->pixels[640 * 120 - 1]);
    }
    CHECK(frame->exposure_mid > last);
    CHECK(frame->exposure_mid < now());
    last = frame->exposure_mid;
    ++expected;
    sut->release(*frame);
  }
  CHECK(sut->stop().has_value());
  LONGS_EQUAL(60 - damaged, sut->health().frames);
  LONGS_EQUAL(damaged, sut->health().frames_damaged);
  LONGS_EQUAL(lost, sut->health().frames_lost);
  CHECK(damaged + lost < 20);
}

TIMED_TEST(AravisCamera, BracketTakesBothExposuresInTurnAndTellsThemApartAlsoAfterARestart) {
  SERVER_OR_SKIP(server, small_camera(), paint_settings);
  auto sut = *AravisCamera::open({});
  CameraSettings bracket = triggered_settings();
  bracket.second_exposure = Nanoseconds{2'000'000};
  for (int restart = 0; restart < 2; ++restart) {
    CHECK(sut->configure(bracket).has_value());
    CHECK(sut->start().has_value());
    for (int i = 0; i < 7; ++i) {
      const TriggeredFrame got = triggered_frame(*server, *sut);
      LONGS_EQUAL(i % 2 == 0 ? 50 : 200, got.exposure_10us);
      LONGS_EQUAL(i % 2 == 0 ? 0U : std::uint32_t{k_frame_second_exposure}, got.frame.flags);
      CHECK(got.strobe);
    }
    CHECK_EQUAL(static_cast<int>(Errc::NotSupported),
                static_cast<int>(sut->adjust_exposure(Nanoseconds{100'000}).error().code));
    CHECK(sut->stop().has_value());
  }
}

TIMED_TEST(AravisCamera, LaserOffFramesComeInTurnWithoutStrobe) {
  SERVER_OR_SKIP(server, small_camera(), paint_settings);
  auto sut = *AravisCamera::open({});
  CameraSettings pairs = triggered_settings();
  pairs.laser_off_frames = true;
  CHECK(sut->configure(pairs).has_value());
  CHECK(sut->start().has_value());
  for (int i = 0; i < 6; ++i) {
    const TriggeredFrame got = triggered_frame(*server, *sut);
    LONGS_EQUAL(50, got.exposure_10us);
    CHECK_EQUAL(i % 2 == 0, got.strobe);
    LONGS_EQUAL(i % 2 == 0 ? 0U : std::uint32_t{k_frame_laser_off}, got.frame.flags);
  }
  CHECK(sut->stop().has_value());
  // And without them every frame is lit again.
  CHECK(sut->configure(triggered_settings()).has_value());
  CHECK(sut->start().has_value());
  for (int i = 0; i < 3; ++i) CHECK(triggered_frame(*server, *sut).strobe);
}

TIMED_TEST(AravisCamera, ChangedExposureHoldsFromTheNextFrameOnAndStampsStayTheMiddle) {
  SERVER_OR_SKIP(server, small_camera(), paint_settings);
  auto sut = *AravisCamera::open({});
  CHECK(sut->configure(triggered_settings()).has_value());
  CHECK(sut->start().has_value());
  for (const int exposure_10us : {50, 30, 120}) {
    CHECK(sut->adjust_exposure(Nanoseconds{exposure_10us * 10'000}).has_value());
    for (int i = 0; i < 3; ++i) LONGS_EQUAL(exposure_10us, triggered_frame(*server, *sut).exposure_10us);
  }
  // An edge from before the change is exposed as it was then, however late its picture comes.
  const auto edge = now();
  server->trigger(edge);
  CHECK(sut->adjust_exposure(Nanoseconds{2'000'000}).has_value());
  const auto frame = sut->next_frame(k_second);
  CHECK(frame.has_value());
  LONGS_EQUAL(120, frame->pixels[0]);
  LONGS_EQUAL((edge + Nanoseconds{600'000}).time_since_epoch().count(),
              frame->exposure_mid.time_since_epoch().count());
}

TIMED_TEST(AravisCamera, ChangedRowsTellTheirPlaceInTheRegion) {
  SERVER_OR_SKIP(server, small_camera(), paint_settings);
  auto sut = *AravisCamera::open({});
  CHECK(sut->configure(triggered_settings()).has_value());
  CHECK(sut->start().has_value());
  // Aravis' fake camera sends pictures as large as the first one at most.
  LONGS_EQUAL(120, triggered_frame(*server, *sut).frame.height_px);
  std::uint64_t expected = 1;
  for (const RowRange& rows : {RowRange{40, 60}, RowRange{20, 60}, RowRange{0, 120}, RowRange{100, 20}}) {
    const auto got = sut->adjust_rows(rows);
    CHECK(got.has_value());
    // To within a step: equal heights could not be told apart.
    CHECK(std::abs(got->height_px - rows.height_px) <= 4 && got->first_px == rows.first_px);
    for (int i = 0; i < 3; ++i) {
      const TriggeredFrame frame = triggered_frame(*server, *sut);
      LONGS_EQUAL(got->first_px, frame.frame.first_row_px);
      LONGS_EQUAL(got->height_px, frame.frame.height_px);
      LONGS_EQUAL(100 + got->first_px, frame.offset_v_px);
      LONGS_EQUAL(expected++, frame.frame.sequence);
    }
  }
  CHECK_EQUAL(static_cast<int>(Errc::BadValue), static_cast<int>(sut->adjust_rows({100, 60}).error().code));
}

TIMED_TEST(AravisCamera, HardwareTriggerGivesOneFrameForEachEdgeStampedWithIt) {
  SERVER_OR_SKIP(server, small_camera());
  auto sut = *AravisCamera::open({});
  CHECK(sut->clock_follows_ptp());
  CameraSettings triggered = settings(100);
  triggered.trigger = Trigger::Hardware;
  CHECK(sut->configure(triggered).has_value());
  CHECK(sut->start().has_value());
  CHECK_EQUAL(static_cast<int>(Errc::Timeout),
              static_cast<int>(sut->next_frame(Nanoseconds{50'000'000}).error().code));
  for (int i = 0; i < 10; ++i) {
    const auto edge = now();
    server->trigger(edge);
    const auto frame = sut->next_frame(k_second);
    CHECK(frame.has_value());
    LONGS_EQUAL((edge + Nanoseconds{250'000}).time_since_epoch().count(),
                frame->exposure_mid.time_since_epoch().count());
    sut->release(*frame);
  }
  CHECK_EQUAL(static_cast<int>(Errc::Timeout),
              static_cast<int>(sut->next_frame(Nanoseconds{50'000'000}).error().code));
}

// A busy machine draws pictures late.  A real camera would have exposed all the same: no edge is lost by
// that, each frame has its own edge's stamp, and only an edge within the exposure before it makes none.
TIMED_TEST(AravisCamera, EdgesWhosePicturesAreDrawnLateAreNotLost) {
  std::atomic<bool> held{true};
  SERVER_OR_SKIP(server, small_camera(), [&](const GvExposure& exposure, std::span<std::uint8_t> pixels) {
    while (held) std::this_thread::sleep_for(std::chrono::milliseconds{1});
    paint_number(exposure, pixels);
  });
  auto sut = *AravisCamera::open({});
  // All come in one burst: small ones, which fit any system's socket buffer.
  CameraSettings small = triggered_settings();
  small.region.width_px = 64;
  small.region.height_px = 16;
  CHECK(sut->configure(small).has_value());
  CHECK(sut->start().has_value());
  constexpr int k_edges = 12;
  constexpr Nanoseconds k_period{10'000'000};
  const auto first = now();
  for (int i = 0; i < k_edges; ++i) {
    server->trigger(first + i * k_period);
    server->trigger(first + i * k_period + Nanoseconds{100'000});  // the exposure takes 500 us
  }
  held = false;
  for (int i = 0; i < k_edges; ++i) {
    const auto frame = sut->next_frame(k_second);
    CHECK(frame.has_value());
    LONGS_EQUAL(i, frame->sequence);
    LONGS_EQUAL((first + i * k_period + Nanoseconds{250'000}).time_since_epoch().count(),
                frame->exposure_mid.time_since_epoch().count());
    sut->release(*frame);
  }
  LONGS_EQUAL(k_edges, server->triggers_missed());
}

TIMED_TEST(AravisCamera, ACameraWithAClockOfItsOwnIsMappedByArrivalAndSaidToBeUnsure) {
  GvCamera::Config config = small_camera();
  config.ptp = false;
  config.clock_offset = Nanoseconds{-123'456'789'000};
  SERVER_OR_SKIP(server, config);
  auto sut = *AravisCamera::open({});
  CHECK(sut->configure(settings(200)).has_value());
  CHECK(sut->start().has_value());
  for (int i = 0; i < 20; ++i) {
    const auto frame = sut->next_frame(k_second);
    CHECK(frame.has_value());
    CHECK((frame->flags & k_frame_stamp_uncertain) != 0);
    CHECK(std::chrono::abs(now() - frame->exposure_mid) < k_second);
    sut->release(*frame);
  }
}

TIMED_TEST(AravisCamera, ALostCameraIsSaidAndCanBeOpenedAgain) {
  auto server = open_server(small_camera());
  if (!server) return;
  auto sut = *AravisCamera::open({});
  CHECK(sut->configure(settings(100)).has_value());
  CHECK(sut->start().has_value());
  sut->release(*sut->next_frame(k_second));
  server.reset();
  Errc code = Errc::Timeout;
  // Aravis sends a heartbeat each second and gives up after a few unanswered ones.
  for (int i = 0; i < 150 && code != Errc::DeviceLost; ++i) {
    const auto frame = sut->next_frame(Nanoseconds{100'000'000});
    if (frame) {
      sut->release(*frame);
    } else {
      code = frame.error().code;
    }
  }
  CHECK_EQUAL(static_cast<int>(Errc::DeviceLost), static_cast<int>(code));
  CHECK_FALSE(sut->health().connected);
  CHECK(sut->stop().has_value());

  server = open_server(small_camera());
  if (!server) return;
  auto again = AravisCamera::open({});
  CHECK(again.has_value());
  CHECK((*again)->configure(settings(100)).has_value());
  CHECK((*again)->start().has_value());
  CHECK((*again)->next_frame(k_second).has_value());
}

TEST(AravisCamera, NoCameraAtTheAddressIsAnErrorThatNamesIt) {
  const auto camera = AravisCamera::open({.address = "127.0.0.77"});
  CHECK_FALSE(camera.has_value());
  CHECK(camera.error().where.view().find("127.0.0.77") != std::string_view::npos);
}

}  // namespace biteline::hal
