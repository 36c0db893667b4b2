// SPDX-License-Identifier: MIT
/// \file A live scan as one MCAP file: what is in it, and what is left of it when it is cut or the disk is
/// full.
#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <random>
#include <thread>

#include "common/mcap/reader.hpp"
#include "common/mcap/verify.hpp"
#include "firmware/record/session_recorder.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/full_disk.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::record {
namespace {

constexpr int k_width_px = 320, k_height_px = 240;

SensorClock::time_point at_ms(std::int64_t ms) {
  return SensorClock::time_point{std::chrono::milliseconds{ms}};
}

struct Read {
  std::map<std::string, std::uint64_t> messages;  ///< by topic
  std::string facts;                              ///< the last recording.yaml
  std::string last_pose;                          ///< JSON
  std::string damage;
};

Read read(const std::filesystem::path& file) {
  Read all;
  const auto end = mcap::read_messages(
      file, {.on_message =
                 [&](const mcap::Channel& channel, const mcap::Schema*, const mcap::Message& message) {
                   ++all.messages[channel.topic];
                   if (channel.topic == "/pose0/pose")
                     all.last_pose.assign(message.data.begin(), message.data.end());
                   return Result<void>{};
                 },
             .on_attachment =
                 [&](const mcap::Attachment& attachment) {
                   if (attachment.name == "recording.yaml")
                     all.facts.assign(attachment.data.begin(), attachment.data.end());
                   return Result<void>{};
                 },
             .on_metadata = {}});
  SUCCEEDS(end);
  all.damage = end->damage;
  return all;
}

}  // namespace

TEST_GROUP(McapFile) {
  test::TemporaryFolder folder;
  std::filesystem::path file = folder.path() / "live.mcap";
  geometry::SensorModel model;
  std::vector<std::uint8_t> pixels = std::vector<std::uint8_t>(k_width_px * k_height_px);
  wire::Bytes hello;
  std::unique_ptr<SessionRecorder> recorder;

  void setup() override {
    model.camera = {.fu_px = 2000, .fv_px = 2001, .cu_px = 160, .cv_px = 120};
    model.laser_plane = {.normal_cam = Vec3{0, 0.6, 0.8}, .distance_mm = 150};
    model.region = {.offset_u_px = 0, .offset_v_px = 0, .width_px = k_width_px, .height_px = k_height_px};
    model.pose_clock_offset = Nanoseconds{7'000'000};
    // Noise packs to no less: a picture of 77 kB.
    std::mt19937 random{5};
    for (std::uint8_t& pixel : pixels) pixel = static_cast<std::uint8_t>(random());
    wire::SensorHello said;
    said.model = model;
    wire::encode({.scan_id = 7, .body = std::move(said)}, hello);
    auto begun = SessionRecorder::begin({.path = file,
                                         .model = model,
                                         .facts = {.sensor = "left",
                                                   .version = "0",
                                                   .peak_threshold_grey = 12,
                                                   .peak_width_min_px = 1.5,
                                                   .peak_width_max_px = 24},
                                         .settings = "camera: {}\n",
                                         .realtime = runtime::RealtimeDemand::Ignored});
    SUCCEEDS(begun);
    recorder = std::move(*begun);
  }
  void keep(int number) {
    recorder->tap()->rt_keep_pose({.stamp = at_ms(number),
                                   .rotation = Eigen::Quaterniond{0.1, 0.7, 0.5, 0.3}.normalized(),
                                   .translation_mm = {1.0 / 3, -200.0 / 7, 1e-7},
                                   .encoder_ticks = -7700 - number});
    recorder->tap()->rt_keep_frame({.pixels = pixels,
                                    .width_px = k_width_px,
                                    .height_px = k_height_px,
                                    .first_row_px = 0,
                                    .stride_bytes = k_width_px,
                                    .sequence = static_cast<std::uint64_t>(number),
                                    .exposure_mid = at_ms(number)});
  }
  void finish() {
    recorder->request_finish(0);
    recorder.reset();
  }
  std::string bytes() const {
    std::string all(std::filesystem::file_size(file), '\0');
    std::unique_ptr<std::FILE, int (*)(std::FILE*)> in{std::fopen(file.c_str(), "rb"), &std::fclose};
    LONGS_EQUAL(all.size(), std::fread(all.data(), 1, all.size(), in.get()));
    return all;
  }
};

TEST(McapFile, EndedScanIsWholeAndEverySumHolds) {
  recorder->keep_message(hello);
  for (int i = 0; i < 5; ++i) keep(10 * i);
  finish();
  const auto verdict = mcap::verify(file);
  SUCCEEDS(verdict);
  CHECK(verdict->faults.empty());
  const Read all = read(file);
  LONGS_EQUAL(5, all.messages.at("/cam0/image"));
  LONGS_EQUAL(5, all.messages.at("/cam0/frame"));
  LONGS_EQUAL(5, all.messages.at("/pose0/pose"));
  LONGS_EQUAL(1, all.messages.at("/scan/message"));
  LONGS_EQUAL(1, all.messages.at("/scan/event"));
  STRCMP_CONTAINS("\"encoder_ticks\":-7740}", all.last_pose.c_str());
  STRCMP_CONTAINS("complete: true", all.facts.c_str());
  STRCMP_CONTAINS("pictures: 5", all.facts.c_str());
}

TEST(McapFile, CutFileGivesAllBeforeTheCut) {
  recorder->keep_message(hello);
  for (int i = 0; i < 60; ++i) {
    keep(i);
    // As a camera would: the tap has room for 64 pictures, and none is to be left out here.
    std::this_thread::sleep_for(std::chrono::milliseconds{1});
  }
  finish();
  const std::string whole = bytes();
  const Read all = read(file);
  LONGS_EQUAL(60, all.messages.at("/cam0/image"));
  std::uint64_t before = 0;
  for (const double share : {0.4, 0.7, 0.95}) {
    const auto cut =
        folder.write("cut.mcap", whole.substr(0, static_cast<std::size_t>(share * whole.size())));
    Read left = read(cut);
    CHECK(!left.damage.empty());
    STRCMP_CONTAINS("complete: false", left.facts.c_str());
    const std::uint64_t pictures = left.messages["/cam0/image"];
    // Of the file a chunk of 1 MB at most is lost with the cut, some 13 pictures.
    CHECK(static_cast<double>(pictures) >= 60 * share - 15);
    CHECK(pictures > before && pictures < 60);
    before = pictures;
  }
}

TEST(McapFile, FullDiskEndsTheFileAndWhatWasWrittenIsRead) {
  const test::FullDisk full{3U << 20U};
  recorder->keep_message(hello);
  for (int i = 0; i < 60; ++i) keep(i);
  finish();
  CHECK(std::filesystem::file_size(file) <= 3U << 20U);
  Read left = read(file);
  CHECK(!left.damage.empty());
  STRCMP_CONTAINS("complete: false", left.facts.c_str());
  // Chunks of some 1.05 MB: two are whole.
  CHECK(left.messages["/cam0/image"] >= 20 && left.messages["/cam0/image"] < 60);
  LONGS_EQUAL(1, left.messages["/scan/message"]);
}

TEST(McapFile, ScanThatNeverBeganLeavesNoFile) {
  recorder->discard();
  CHECK(!std::filesystem::exists(file));
}

TEST(McapFile, NothingIsOverwrittenAndTheNextNameKeepsItsEnding) {
  finish();
  const auto again = SessionRecorder::begin(
      {.path = file, .model = model, .facts = {}, .realtime = runtime::RealtimeDemand::Ignored});
  CHECK(!again.has_value());
  STRCMP_EQUAL("live-2.mcap", free_name(file).filename().c_str());
}

TEST(McapFile, OldestFilesMakeRoomAndThoseOfOthersStay) {
  finish();
  folder.write("live-2.mcap", "another's");
  LONGS_EQUAL(1, make_room(file, 0));
  CHECK(!std::filesystem::exists(file));
  CHECK(std::filesystem::exists(folder.path() / "live-2.mcap"));
}

}  // namespace biteline::record
