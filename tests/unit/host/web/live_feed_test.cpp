// SPDX-License-Identifier: MIT
#include "host/apps/biteline-web/live_feed.hpp"

#include <CppUTest/TestHarness.h>

#include <cstring>
#include <nlohmann/json.hpp>

#include "host/apps/biteline-web/sensor_state.hpp"
#include "tests/support/json.hpp"

namespace biteline::web {
namespace {

LiveBytes text(const std::string& words) {
  return std::make_shared<const std::string>(words);
}

template <class Number>
Number number_at(const std::string& bytes, std::size_t offset) {
  Number number{};
  CHECK(offset + sizeof number <= bytes.size());
  std::memcpy(&number, bytes.data() + offset, sizeof number);
  return number;
}

}  // namespace

TEST_GROUP(LiveMessages){};

TEST_GROUP(LiveFeed) {
  LiveFeed sut;
  int wakes = 0;
  std::shared_ptr<LiveQueue> watch() {
    auto queue = std::make_shared<LiveQueue>([this] { ++wakes; });
    sut.add(queue);
    return queue;
  }
};

TEST(LiveFeed, ASlowWatcherGetsTheNewestPictureOnly) {
  const auto slow = watch();
  for (const char* words : {"1", "2", "3"}) sut.publish(LiveKind::Picture, text(words));
  LONGS_EQUAL(3, wakes);
  STRCMP_EQUAL("3", slow->take()->c_str());
  CHECK(slow->take() == nullptr);
  LONGS_EQUAL(2, slow->skipped());
}

TEST(LiveFeed, KindsTakeTurns) {
  const auto queue = watch();
  sut.publish(LiveKind::Picture, text("picture"));
  sut.publish(LiveKind::Profile, text("profile"));
  STRCMP_EQUAL("picture", queue->take()->c_str());
  sut.publish(LiveKind::Picture, text("next picture"));
  STRCMP_EQUAL("profile", queue->take()->c_str());
  STRCMP_EQUAL("next picture", queue->take()->c_str());
}

TEST(LiveFeed, TheCloudComesInOrderAndToLateOnesToo) {
  sut.publish(LiveKind::Cloud, text("a"));
  sut.publish(LiveKind::Cloud, text("b"));
  sut.publish(LiveKind::Line, text("line"));
  const auto late = watch();
  STRCMP_EQUAL("a", late->take()->c_str());
  STRCMP_EQUAL("line", late->take()->c_str());
  STRCMP_EQUAL("b", late->take()->c_str());
  sut.forget_scan();
  CHECK(watch()->take() == nullptr);
}

TEST(LiveFeed, MemoryIsBoundedHoweverSlowTheWatcher) {
  const auto slow = watch();
  for (std::size_t i = 0; i < 2 * LiveQueue::k_most_pieces; ++i) {
    sut.publish(LiveKind::Cloud, text(std::to_string(i)));
  }
  LONGS_EQUAL(LiveQueue::k_most_pieces, slow->skipped());
  STRCMP_EQUAL("256", slow->take()->c_str());
  const auto events = std::make_shared<EventQueue>([] {});
  sut.add(events);
  for (std::size_t i = 0; i < 2 * EventQueue::k_most_waiting; ++i) sut.publish_event(std::to_string(i));
  STRCMP_EQUAL("256", events->take()->c_str());
}

TEST(LiveFeed, WhoIsGoneIsForgotten) {
  {
    const auto gone = watch();
    LONGS_EQUAL(1, sut.watchers());
  }
  sut.publish(LiveKind::Picture, text("x"));
  LONGS_EQUAL(0, sut.watchers());
}

TEST(LiveFeed, MessagesHaveTheBytesOfTheDescription) {
  profile::Profile profile;
  profile.header.sequence = 7;
  profile.header.exposure_mid = SensorClock::time_point{Nanoseconds{1234567890123}};
  profile.points.resize(2);
  profile.points[0].point_cam = {1.5F, 2.5F, 300.25F};
  profile.points[0].flags = profile::k_point_wide;
  profile.points[1].flags = profile::k_point_edge_mixed;
  const LiveBytes bytes = profile_message(profile);
  LONGS_EQUAL(15 + 2 * 9, bytes->size());
  LONGS_EQUAL(2, bytes->front());
  LONGS_EQUAL(7, number_at<std::uint32_t>(*bytes, 1));
  CHECK(number_at<std::uint64_t>(*bytes, 5) == 1234567890123);
  LONGS_EQUAL(2, number_at<std::uint16_t>(*bytes, 13));
  CHECK(number_at<float>(*bytes, 15) == 1.5F);
  CHECK(number_at<float>(*bytes, 19) == 300.25F);
  LONGS_EQUAL(profile::k_point_wide, number_at<std::uint8_t>(*bytes, 23));
  LONGS_EQUAL(profile::k_point_clipped, number_at<std::uint8_t>(*bytes, 32));

  const LiveBytes picture =
      picture_message({.sequence = 3, .time_ns = 4}, std::array<std::uint8_t, 2>{0xFF, 0xD8});
  LONGS_EQUAL(15, picture->size());
  LONGS_EQUAL(1, picture->front());
  LONGS_EQUAL(0xD8, number_at<std::uint8_t>(*picture, 14));

  wire::Picture seen;
  seen.frame_sequence = 3;
  seen.region = {.offset_u_px = 100, .offset_v_px = 40, .width_px = 640, .height_px = 120};
  seen.step = 2;
  seen.peaks = {{.u_px = 101, .v_px = 50.5F, .flags = profile::k_point_edge_mixed}, {}};
  const LiveBytes peaks = peaks_message(seen);
  LONGS_EQUAL(17 + 2 * 7, peaks->size());
  LONGS_EQUAL(6, peaks->front());
  LONGS_EQUAL(40, number_at<std::uint16_t>(*peaks, 7));
  LONGS_EQUAL(2, number_at<std::uint16_t>(*peaks, 13));
  LONGS_EQUAL(2, number_at<std::uint16_t>(*peaks, 15));
  LONGS_EQUAL(101, number_at<std::uint16_t>(*peaks, 17));
  CHECK(number_at<float>(*peaks, 19) == 50.5F);
  LONGS_EQUAL(profile::k_point_clipped, number_at<std::uint8_t>(*peaks, 23));

  const std::vector<LivePoint> points{
      {.point_base = {1, 2, 3}}, {.point_base = {4, 5, 6}, .curvature_per_mm = 0.25F, .sigma_mm = 0.125F}};
  const LiveBytes cloud = cloud_message(9, points);
  LONGS_EQUAL(9 + 40, cloud->size());
  LONGS_EQUAL(9, number_at<std::uint32_t>(*cloud, 1));
  LONGS_EQUAL(2, number_at<std::uint32_t>(*cloud, 5));
  CHECK(number_at<float>(*cloud, 37) == 6.0F);
  CHECK(number_at<float>(*cloud, 41) == 0.25F);
  CHECK(number_at<float>(*cloud, 45) == 0.125F);

  cloud::ClosedLine line;
  line.points.resize(1);
  line.points[0].position = {1, 2, 3};
  line.points[0].confidence = 0.5;
  line.points[0].u95_mm = 0.25;
  const LiveBytes line_bytes = line_message(line);
  LONGS_EQUAL(5 + 20, line_bytes->size());
  CHECK(number_at<float>(*line_bytes, 17) == 0.5F);
  CHECK(number_at<float>(*line_bytes, 21) == 0.25F);

  const LiveBytes arm =
      arm_message({.time_s = 2, .joints_rad = {1, 2, 3, 4, 5, 6}, .tip_base_mm = {7, 8, 9}});
  LONGS_EQUAL(81, arm->size());
  CHECK(number_at<double>(*arm, 73) == 9.0);
}

TEST(LiveMessages, SensorTellsWhatItRunsWithAndWhatEachKeyMayBe) {
  wire::SensorHello sensor;
  sensor.name = "head 3";
  wire::Health health;
  health.laser_reason = "the door is open";
  const auto bare = test::read_json(sensor_state(sensor, health));
  CHECK(!bare.contains("settings") && !bare.contains("temperature_degc"));
  STRCMP_EQUAL("the door is open", bare.at("laser_reason").get<std::string>().c_str());
  health.settings =
      wire::SettingsState{.text = "camera:\n  exposure_us: 250\n...\n", .rate_max_hz = 120, .changes = 1};
  const auto json = test::read_json(sensor_state(sensor, health));
  LONGS_EQUAL(120, json.at("rate_max_hz").get<int>());
  const auto& exposure = json.at("settings").at(0);
  STRCMP_EQUAL("camera.exposure_us", exposure.at("key").get<std::string>().c_str());
  STRCMP_EQUAL("250 us", exposure.at("value").get<std::string>().c_str());
  LONGS_EQUAL(250, exposure.at("now").get<int>());
  STRCMP_EQUAL("number", exposure.at("kind").get<std::string>().c_str());
  LONGS_EQUAL(1, exposure.at("range").at(0).get<int>());
  CHECK(json.at("settings").at(1).at("now").is_null());
  CHECK(json.at("settings").at(7).at("now") == false);
  LONGS_EQUAL(17, json.at("settings").size());
  CHECK(!json.contains("upkeep"));
  health.upkeep = wire::UpkeepState{.lightings = 512, .coldest_degc = {}, .hottest_degc = {}};
  LONGS_EQUAL(512, test::read_json(sensor_state(sensor, health)).at("upkeep").at("lightings").get<int>());
  // A broken set takes nothing else with it.
  health.settings->text = "camera: [";
  CHECK(!test::read_json(sensor_state(sensor, health)).contains("settings"));
}

}  // namespace biteline::web
