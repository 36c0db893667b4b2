// SPDX-License-Identifier: MIT
#include "host/apps/biteline-web/foxglove/foxglove_talk.hpp"

#include <CppUTest/TestHarness.h>

#include <array>
#include <cstring>

#include "foxglove/schemas.pb.h"
#include "host/interfaces/control/messages.hpp"

namespace biteline::web {

using control::Json;

TEST_GROUP(FoxgloveTalk) {
  FoxgloveTalk sut;
  static constexpr std::uint64_t k_now_ns = 1'700'000'000'000'000'123;

  /// What stands behind opcode, subscription and time.
  static std::string content(const std::string& message, std::uint32_t subscription) {
    std::uint32_t id = 0;
    std::uint64_t time_ns = 0;
    CHECK(message.size() > 13);
    std::memcpy(&id, message.data() + 1, sizeof id);
    std::memcpy(&time_ns, message.data() + 5, sizeof time_ns);
    LONGS_EQUAL(1, message.front());
    LONGS_EQUAL(subscription, id);
    CHECK(time_ns == k_now_ns);
    return message.substr(13);
  }
};

TEST(FoxgloveTalk, TheChannelsBringTheirSchemas) {
  const std::vector<std::string> words = FoxgloveTalk::first_words();
  LONGS_EQUAL(2, words.size());
  const Json advertise = Json::parse(words[1]);
  LONGS_EQUAL(2, advertise["channels"].size());
  for (const Json& channel : advertise["channels"]) {
    STRCMP_EQUAL("protobuf", channel["encoding"].get<std::string>().c_str());
    const auto schema = channel["schema"].get<std::string>();
    LONGS_EQUAL(0, schema.size() % 4);
    // A FileDescriptorSet begins with its first file's field, 0x0A: "C" in base64 stands for its upper six
    // bits.
    LONGS_EQUAL('C', schema.front());
    CHECK(schema.size() > 500);
  }
  STRCMP_EQUAL("foxglove.PointCloud", advertise["channels"][1]["schemaName"].get<std::string>().c_str());
}

TEST(FoxgloveTalk, PointsComeInMetres) {
  sut.hear(R"({"op":"subscribe","subscriptions":[{"id":7,"channelId":2}]})");
  const std::vector<LivePoint> points{
      {.point_base = {1000, 2000, -3000}, .curvature_per_mm = 0.25F, .sigma_mm = 0.5F}};
  const auto messages = sut.messages(*cloud_message(1, points), k_now_ns);
  LONGS_EQUAL(1, messages.size());
  foxglove::PointCloud cloud;
  CHECK(cloud.ParseFromString(content(messages[0], 7)));
  LONGS_EQUAL(20, cloud.point_stride());
  LONGS_EQUAL(5, cloud.fields_size());
  LONGS_EQUAL(20, cloud.data().size());
  std::array<float, 5> point{};
  std::memcpy(point.data(), cloud.data().data(), sizeof point);
  DOUBLES_EQUAL(-3, point[2], 1e-6);
  DOUBLES_EQUAL(250, point[3], 1e-3);
  DOUBLES_EQUAL(0.0005, point[4], 1e-9);
  LONGS_EQUAL(1'700'000'000, cloud.timestamp().seconds());
  LONGS_EQUAL(123, cloud.timestamp().nanos());
}

TEST(FoxgloveTalk, OnlyWhatWasAskedForIsSent) {
  const auto picture =
      picture_message({.sequence = 1, .time_ns = 2}, std::vector<std::uint8_t>{0xFF, 0xD8, 0xFF});
  CHECK(sut.messages(*picture, k_now_ns).empty());
  sut.hear(R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":1},{"id":2,"channelId":1}]})");
  const auto messages = sut.messages(*picture, k_now_ns);
  LONGS_EQUAL(2, messages.size());
  foxglove::CompressedImage image;
  CHECK(image.ParseFromString(content(messages[1], 2)));
  STRCMP_EQUAL("jpeg", image.format().c_str());
  LONGS_EQUAL(3, image.data().size());
  sut.hear(R"({"op":"unsubscribe","subscriptionIds":[1,2]})");
  CHECK(sut.messages(*picture, k_now_ns).empty());
}

TEST(FoxgloveTalk, OddWordsAreLeftOut) {
  for (const char* text :
       {"", "{", "3", "[]", R"({"op":3})", R"({"op":"subscribe"})", R"({"op":"subscribe","subscriptions":3})",
        R"({"op":"subscribe","subscriptions":[3,{"id":-1,"channelId":1},{"id":"x"}]})",
        R"({"op":"unsubscribe","subscriptionIds":["x",-3]})"}) {
    sut.hear(text);
  }
  for (int i = 0; i < 1000; ++i) {
    sut.hear(R"({"op":"subscribe","subscriptions":[{"id":)" + std::to_string(i) + R"(,"channelId":1}]})");
  }
  const auto picture = picture_message({}, std::vector<std::uint8_t>{1});
  LONGS_EQUAL(64, sut.messages(*picture, k_now_ns).size());
  CHECK(sut.messages("", k_now_ns).empty());
  CHECK(sut.messages("\x01", k_now_ns).empty());
}

TEST(FoxgloveTalk, TheOfferedNameIsTaken) {
  STRCMP_EQUAL("foxglove.sdk.v1", std::string{choose_foxglove_protocol("foxglove.sdk.v1")}.c_str());
  STRCMP_EQUAL("foxglove.websocket.v1",
               std::string{choose_foxglove_protocol("a, foxglove.websocket.v1 ,b")}.c_str());
  CHECK(choose_foxglove_protocol("").empty());
  CHECK(choose_foxglove_protocol("foxglove.websocket.v2,").empty());
}

}  // namespace biteline::web
