// SPDX-License-Identifier: MIT
#include "firmware/record/session_recorder.hpp"

#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <chrono>

#include "common/image/grey_image.hpp"
#include "common/session/session.hpp"
#include "common/wire/scan_file.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::record {
namespace {

constexpr int k_width_px = 640, k_height_px = 480;

SensorClock::time_point at_ms(std::int64_t ms) {
  return SensorClock::time_point{std::chrono::milliseconds{ms}};
}

wire::Bytes hello_of(const geometry::SensorModel& model) {
  wire::SensorHello hello;
  hello.model = model;
  wire::Bytes bytes;
  wire::encode({.scan_id = 7, .body = std::move(hello)}, bytes);
  return bytes;
}

}  // namespace

TEST_GROUP(SessionRecorder) {
  test::TemporaryFolder folder;
  geometry::SensorModel model;
  std::vector<std::uint8_t> pixels = std::vector<std::uint8_t>(k_width_px * k_height_px);
  std::unique_ptr<SessionRecorder> recorder;

  void setup() override {
    model.camera = {.fu_px = 2000, .fv_px = 2001, .cu_px = 320, .cv_px = 240};
    model.laser_plane = {.normal_cam = Vec3{0, 0.6, 0.8}, .distance_mm = 150};
    model.region = {.offset_u_px = 0, .offset_v_px = 0, .width_px = k_width_px, .height_px = k_height_px};
    model.pose_clock_offset = Nanoseconds{7'000'000};
    for (std::size_t i = 0; i < pixels.size(); ++i)
      pixels[i] = static_cast<std::uint8_t>(i * 2654435761U >> 13U);
  }
  std::filesystem::path session() const {
    return folder.path() / "live";
  }
  void begin(std::uint32_t every = 1) {
    auto begun = SessionRecorder::begin({.path = session(),
                                         .model = model,
                                         .facts = {.sensor = "a \"sensor\"",
                                                   .peak_threshold_grey = 12,
                                                   .peak_width_min_px = 1.5,
                                                   .peak_width_max_px = 24,
                                                   .pictures_every = every},
                                         .realtime = runtime::RealtimeDemand::Ignored});
    SUCCEEDS(begun);
    recorder = std::move(*begun);
  }
  void keep_frame(int number, int rows_px = k_height_px) {
    recorder->tap()->rt_keep_frame({.pixels = pixels,
                                    .width_px = k_width_px,
                                    .height_px = rows_px,
                                    .first_row_px = k_height_px - rows_px,
                                    .stride_bytes = k_width_px,
                                    .sequence = static_cast<std::uint64_t>(number) + 100,
                                    .exposure_mid = at_ms(number),
                                    .flags = number % 2 == 0 ? 0U : hal::k_frame_laser_off});
  }
  void keep_pose(int number, std::optional<std::int64_t> encoder_ticks = std::nullopt) {
    recorder->tap()->rt_keep_pose({.stamp = at_ms(number),
                                   .rotation = Eigen::Quaterniond{0.1, 0.7, 0.5, 0.3}.normalized(),
                                   .translation_mm = {1.0 / 3, -200.0 / 7, 1e-7},
                                   .encoder_ticks = encoder_ticks});
  }
};

TEST(SessionRecorder, WhatIsReadBackIsWhatWasKeptToTheLastBit) {
  begin();
  for (int i = 0; i < 5; ++i) {
    keep_pose(10 * i, -(std::int64_t{1} << (10 * i)));
    keep_frame(10 * i, i == 3 ? 64 : k_height_px);
  }
  recorder->keep_message(hello_of(model));
  recorder->request_finish(0);
  recorder.reset();

  const auto read = session::read_session(session());
  SUCCEEDS(read);
  CHECK(read->recorded->complete);
  STRCMP_EQUAL("a sensor", read->recorded->sensor.c_str());
  LONGS_EQUAL(5, read->frames.size());
  LONGS_EQUAL(130, read->frames[3].sequence);
  LONGS_EQUAL(64, read->frames[3].rows_px);
  LONGS_EQUAL(k_height_px - 64, read->frames[3].first_row_px);
  const auto picture = image::read_png(read->frames[2].file);
  SUCCEEDS(picture);
  CHECK(picture->pixels == pixels);
  LONGS_EQUAL(5, read->poses.size());
  CHECK(to_sensor_clock(read->poses[1].stamp, model.pose_clock_offset) == at_ms(10));
  const SE3 kept =
      geometry::make_se3(Eigen::Quaterniond{0.1, 0.7, 0.5, 0.3}.normalized(), {1.0 / 3, -200.0 / 7, 1e-7});
  CHECK(read->poses[1].T_base_flange.matrix() == kept.matrix());
  for (std::size_t i = 0; i < 5; ++i) CHECK(read->poses[i].encoder_ticks == -(std::int64_t{1} << (10 * i)));
}

TEST(SessionRecorder, DiskSlowerThanTheCameraCostsPicturesAndNothingElse) {
  begin();
  // Much faster than any disk: 61 MB in a few milliseconds, into a room of 64 pictures.
  constexpr int k_frames = 200;
  const wire::Bytes hello = hello_of(model);
  for (int i = 0; i < k_frames; ++i) {
    keep_pose(i);
    keep_frame(i);
    recorder->keep_message(hello);
  }
  recorder->request_finish(0);
  recorder.reset();

  const auto read = session::read_session(session());
  SUCCEEDS(read);
  const session::RecordingFacts& facts = *read->recorded;
  CHECK(!facts.complete);
  CHECK(facts.pictures_left_out > 0);
  LONGS_EQUAL(k_frames, facts.pictures + facts.pictures_left_out);
  LONGS_EQUAL(facts.pictures, read->frames.size());
  LONGS_EQUAL(k_frames, read->poses.size());
  LONGS_EQUAL(0, facts.poses_left_out + facts.messages_left_out);
  std::size_t messages = 0;
  const auto scan = wire::read_scan_file(session() / "scan.btln",
                                         [&](const wire::Message&, std::span<const std::uint8_t> bytes) {
                                           messages += std::equal(hello.begin(), hello.end(), bytes.begin());
                                           return Result<void>{};
                                         });
  SUCCEEDS(scan);
  LONGS_EQUAL(k_frames, messages);
}

TEST(SessionRecorder, EveryThirdPictureIsKeptAndTheOthersAreCounted) {
  begin(3);
  for (int i = 0; i < 7; ++i) {
    keep_pose(i);
    keep_frame(i);
  }
  recorder->request_finish(0);
  recorder.reset();
  const auto read = session::read_session(session());
  SUCCEEDS(read);
  LONGS_EQUAL(3, read->recorded->pictures_every);
  LONGS_EQUAL(3, read->frames.size());
  LONGS_EQUAL(103, read->frames[1].sequence);
  LONGS_EQUAL(4, read->recorded->pictures_left_out);
  LONGS_EQUAL(7, read->poses.size());
  CHECK(!read->recorded->complete);
}

TEST(SessionRecorder, RecordingWithoutAnEndSaysSo) {
  begin();
  keep_pose(0);
  keep_frame(0);
  recorder.reset();
  const auto read = session::read_session(session());
  SUCCEEDS(read);
  CHECK(!read->recorded->complete);
  LONGS_EQUAL(0, read->recorded->pictures_left_out);
}

TEST(SessionRecorder, ProfilesThatNoReplayRepeatsAreTold) {
  begin();
  keep_pose(0);
  keep_frame(0);
  recorder->request_finish(3);
  recorder.reset();
  const auto read = session::read_session(session());
  SUCCEEDS(read);
  CHECK(!read->recorded->complete);
  LONGS_EQUAL(3, read->recorded->unrepeatable);
}

TEST(SessionRecorder, ScanThatNeverBeganLeavesNoFolder) {
  begin();
  recorder->discard();
  CHECK(!std::filesystem::exists(session()));
}

TEST(SessionRecorder, NothingIsOverwritten) {
  begin();
  recorder.reset();
  const auto again = SessionRecorder::begin(
      {.path = session(), .model = model, .facts = {}, .realtime = runtime::RealtimeDemand::Ignored});
  CHECK(!again.has_value());
  STRCMP_EQUAL("live-2", free_name(session()).filename().c_str());
}

}  // namespace biteline::record
