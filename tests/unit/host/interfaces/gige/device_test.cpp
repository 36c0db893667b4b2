// SPDX-License-Identifier: MIT
#include "host/interfaces/gige/device.hpp"

#include <CppUTest/TestHarness.h>
#include <arpa/inet.h>

#include <random>

#include "common/gige/bootstrap.hpp"
#include "host/interfaces/gige/device_description.hpp"
#include "tests/support/made_profile.hpp"

namespace biteline {

using namespace std::chrono_literals;
using gige::Status;

TEST_GROUP(GigeDevice) {
  struct Sent {
    gige::Peer to;
    std::vector<std::uint8_t> packet;
  };
  std::vector<Sent> sent;
  gige::Device device{
      {.address = 0x7f00'0001, .mask = 0xff00'0000, .version = "1.2", .serial = "77", .name = {}},
      4000,
      [this](const gige::Peer& to, std::span<const std::uint8_t> packet) {
        sent.push_back({.to = to, .packet = {packet.begin(), packet.end()}});
      }};
  const gige::Peer client{.address = htonl(0x7f00'0001), .port = htons(5000)};
  gige::Device::Clock::time_point now{1h};

  std::optional<std::vector<std::uint8_t>> ask(std::uint16_t code, std::vector<std::uint32_t> words) {
    std::vector<std::uint8_t> packet(8 + 4 * words.size());
    packet[0] = 0x42;
    packet[1] = 1;
    gige::put_half(packet, 2, code);
    gige::put_half(packet, 4, static_cast<std::uint16_t>(4 * words.size()));
    for (std::size_t i = 0; i < words.size(); ++i) gige::put_word(packet, 8 + 4 * i, words[i]);
    return device.on_packet(client, packet, now);
  }
  int status(const std::optional<std::vector<std::uint8_t>>& answer) {
    CHECK(answer.has_value());
    return gige::half_at(*answer, 0);
  }
  int write(std::uint32_t address, std::uint32_t value) {
    return status(ask(gige::command::k_write_register, {address, value}));
  }
  std::uint32_t read(std::uint32_t address) {
    const auto answer = ask(gige::command::k_read_register, {address});
    LONGS_EQUAL(0, status(answer));
    return gige::word_at(*answer, 8);
  }
  void start() {
    using namespace gige::bootstrap;
    device.set_head(500, {});
    LONGS_EQUAL(0, write(k_privilege, 2));
    LONGS_EQUAL(0, write(k_stream_address, 0x7f00'0001));
    LONGS_EQUAL(0, write(k_stream_port, 6000));
    LONGS_EQUAL(0, write(gige::own::k_acquisition, 1));
  }
  static int code(Status status) {
    return static_cast<int>(status);
  }
};

TEST(GigeDevice, ConcatenatedCommandsStopAtTheFirstFault) {
  LONGS_EQUAL(0, write(gige::bootstrap::k_privilege, 2));
  const auto answer = ask(gige::command::k_write_register,
                          {gige::own::k_height, 5, gige::own::k_height, 0, gige::own::k_height, 6});
  LONGS_EQUAL(code(Status::InvalidParameter), status(answer));
  LONGS_EQUAL(1, gige::word_at(*answer, 8));
  LONGS_EQUAL(5, read(gige::own::k_height));
  const auto many = ask(gige::command::k_read_register, {gige::own::k_height, gige::bootstrap::k_version});
  LONGS_EQUAL(0x0002'0000, gige::word_at(*many, 12));
}

TEST(GigeDevice, PicturesGoOutAsMono8AndProfilesDoNot) {
  const gige::PictureShape shape =
      gige::picture_shape({.offset_u_px = 10, .offset_v_px = 20, .width_px = 500, .height_px = 100});
  LONGS_EQUAL(1, shape.step);
  device.set_head(500, {}, shape);
  using namespace gige::bootstrap;
  LONGS_EQUAL(0, write(k_privilege, 2));
  LONGS_EQUAL(0, write(gige::own::k_height, 7));
  LONGS_EQUAL(0, write(gige::own::k_pixel_format, static_cast<std::uint32_t>(gige::Format::Mono8)));
  LONGS_EQUAL(100, read(gige::own::k_height));
  LONGS_EQUAL(code(Status::InvalidParameter), write(gige::own::k_height, 7));
  LONGS_EQUAL(0, write(gige::own::k_chunk_mode, 1));
  LONGS_EQUAL(500 * 100 + 8 + 160 + 8, read(gige::own::k_payload_size));
  LONGS_EQUAL(0, write(k_stream_address, 0x7f00'0001));
  LONGS_EQUAL(0, write(k_stream_port, 6000));
  LONGS_EQUAL(0, write(gige::own::k_acquisition, 1));
  CHECK(device.wants_pictures());
  device.offer(1, test::made_profile(1, 10));
  CHECK(sent.empty());
  // Half of the head's rows, as where the stripe is followed.
  wire::Picture picture;
  picture.profile_sequence = 77;
  picture.region = {.offset_u_px = 10, .offset_v_px = 70, .width_px = 500, .height_px = 50};
  picture.format = wire::PictureFormat::Raw;
  picture.pixels.assign(500 * 50, 9);
  device.offer(3, picture);
  CHECK(sent.size() > 30);
  std::vector<std::uint8_t> payload;
  for (std::size_t i = 1; i + 1 < sent.size(); ++i)
    payload.insert(payload.end(), sent[i].packet.begin() + 8, sent[i].packet.end());
  LONGS_EQUAL(read(gige::own::k_payload_size), payload.size());
  LONGS_EQUAL(0, payload[500 * 50 - 1]);
  LONGS_EQUAL(9, payload[500 * 50]);
  LONGS_EQUAL(9, payload[500 * 100 - 1]);
  LONGS_EQUAL(77, gige::word_at(payload, 500 * 100 + 8 + 20));
  // A picture of another step is none of these.
  const std::size_t before = sent.size();
  LONGS_EQUAL(0, device.pictures_left_out());
  picture.step = 2;
  device.offer(3, picture);
  LONGS_EQUAL(before, sent.size());
  LONGS_EQUAL(1, device.pictures_left_out());
  // Profiles again, as many lines as before.
  LONGS_EQUAL(0, write(gige::own::k_acquisition, 0));
  LONGS_EQUAL(0, write(gige::own::k_pixel_format, static_cast<std::uint32_t>(gige::Format::C16)));
  LONGS_EQUAL(7, read(gige::own::k_height));
}

TEST(GigeDevice, PicturesBeyondAMessageAreBinned) {
  const gige::PictureShape shape =
      gige::picture_shape({.offset_u_px = 0, .offset_v_px = 0, .width_px = 1626, .height_px = 1236});
  LONGS_EQUAL(3, shape.step);
  LONGS_EQUAL(542, shape.columns());
  LONGS_EQUAL(412, shape.rows());
  LONGS_EQUAL(542, gige::wish_for(shape).width_max_px);
  device.set_head(1626, {}, shape);
  LONGS_EQUAL(0, write(gige::bootstrap::k_privilege, 2));
  LONGS_EQUAL(1, read(gige::own::k_binning));
  LONGS_EQUAL(0, write(gige::own::k_pixel_format, static_cast<std::uint32_t>(gige::Format::Mono8)));
  LONGS_EQUAL(3, read(gige::own::k_binning));
  LONGS_EQUAL(542, read(gige::own::k_width));
}

TEST(GigeDevice, NothingComesWithoutAStart) {
  device.set_head(500, {});
  device.offer(1, test::made_profile(1, 10));
  CHECK(sent.empty());
  LONGS_EQUAL(0, write(gige::bootstrap::k_privilege, 2));
  LONGS_EQUAL(code(Status::InvalidParameter), write(gige::own::k_acquisition, 1));
  CHECK_FALSE(device.acquiring());
}

TEST(GigeDevice, FramesGoToTheControllingClientAlone) {
  LONGS_EQUAL(0, write(gige::bootstrap::k_privilege, 2));
  LONGS_EQUAL(code(Status::AccessDenied), write(gige::bootstrap::k_stream_address, 0x0a00'0001));
  start();
  device.offer(1, test::made_profile(1, 10));
  CHECK(!sent.empty());
  for (const Sent& one : sent) {
    LONGS_EQUAL(client.address, one.to.address);
    LONGS_EQUAL(htons(6000), one.to.port);
  }
}

TEST(GigeDevice, AClientThatFallsSilentGetsNoMore) {
  start();
  now += 10s;
  device.tick(now);
  CHECK_FALSE(device.acquiring());
  sent.clear();
  device.offer(1, test::made_profile(1, 10));
  CHECK(sent.empty());
  LONGS_EQUAL(0, read(gige::bootstrap::k_privilege));
  LONGS_EQUAL(0, read(gige::bootstrap::k_stream_port));
}

TEST(GigeDevice, NobodyStartsWithoutControl) {
  using namespace gige::bootstrap;
  device.set_head(500, {});
  const auto answer =
      ask(gige::command::k_write_register,
          {k_privilege, 0, k_stream_address, 0x7f00'0001, k_stream_port, 6000, gige::own::k_acquisition, 1});
  LONGS_EQUAL(code(Status::AccessDenied), status(answer));
  LONGS_EQUAL(1, gige::word_at(*answer, 8));
  CHECK_FALSE(device.acquiring());
}

TEST(GigeDevice, WhoGivesControlBackGetsNoMore) {
  start();
  LONGS_EQUAL(0, write(gige::bootstrap::k_privilege, 0));
  CHECK_FALSE(device.acquiring());
  LONGS_EQUAL(0, read(gige::bootstrap::k_stream_address));
  LONGS_EQUAL(0, read(gige::bootstrap::k_stream_port));
  LONGS_EQUAL(1, device.starts());
  // The next one's start is not aimed at the last one.
  LONGS_EQUAL(0, write(gige::bootstrap::k_privilege, 2));
  LONGS_EQUAL(code(Status::InvalidParameter), write(gige::own::k_acquisition, 1));
  LONGS_EQUAL(1, device.starts());
}

TEST(GigeDevice, AnotherHeadEndsTheStream) {
  start();
  device.set_head(500, {});
  CHECK(device.acquiring());
  device.set_head(501, {});
  CHECK_FALSE(device.acquiring());
  LONGS_EQUAL(501 * 12, read(gige::own::k_payload_size));
}

TEST(GigeDevice, HeadThatSeesElsewhereAcrossIsAnother) {
  start();
  device.set_head(500, {.across = {.offset_mm = -60}});
  CHECK_FALSE(device.acquiring());
}

TEST(GigeDevice, ThePayloadIsAsLongAsItSays) {
  device.set_head(501, {});
  LONGS_EQUAL(0, write(gige::bootstrap::k_privilege, 2));
  for (const auto format : {gige::Format::C16, gige::Format::Abc32f}) {
    for (const std::uint32_t lines : {1U, 3U}) {
      for (const std::uint32_t chunks : {0U, 1U}) {
        LONGS_EQUAL(0, write(gige::own::k_pixel_format, static_cast<std::uint32_t>(format)));
        LONGS_EQUAL(0, write(gige::own::k_height, lines));
        LONGS_EQUAL(0, write(gige::own::k_chunk_mode, chunks));
        LONGS_EQUAL(0, write(gige::bootstrap::k_stream_address, 0x7f00'0001));
        LONGS_EQUAL(0, write(gige::bootstrap::k_stream_port, 6000));
        LONGS_EQUAL(0, write(gige::own::k_acquisition, 1));
        sent.clear();
        device.offer(1, test::made_profile(1, 10));
        device.end_scan();
        std::size_t bytes = 0;
        for (const Sent& one : sent)
          if (one.packet[4] == 3) bytes += one.packet.size() - 8;
        LONGS_EQUAL(read(gige::own::k_payload_size), bytes);
        LONGS_EQUAL(2, sent.back().packet[4]);
        LONGS_EQUAL(0, write(gige::own::k_acquisition, 0));
      }
    }
  }
}

TEST(GigeDevice, GarbledCommandsChangeNothingButWhatTheySay) {
  start();
  std::mt19937 random{3};
  for (int turn = 0; turn < 200'000; ++turn) {
    std::vector<std::uint8_t> packet(random() % 40);
    for (std::uint8_t& byte : packet) byte = static_cast<std::uint8_t>(random());
    if (packet.size() >= 8) {
      packet[0] = 0x42;
      packet[2] = 0;
      packet[3] = static_cast<std::uint8_t>(0x80 + 2 * (random() % 4));
      gige::put_half(packet, 4, static_cast<std::uint16_t>(packet.size() - 8));
    }
    if (packet.size() >= 12)
      gige::put_word(packet, 8, random() % 4 == 0 ? 0xa000 + 4 * (random() % 40) : random());
    const auto answer = device.on_packet(client, packet, now);
    if (answer) CHECK(answer->size() >= 8 && answer->size() <= 576);
    if (turn % 100 == 0) device.offer(1, test::made_profile(1, 10));
    sent.clear();
  }
  CHECK(read(gige::own::k_height) >= 1 && read(gige::own::k_height) <= gige::k_most_lines);
}

}  // namespace biteline
