// SPDX-License-Identifier: MIT
#include "host/interfaces/gige/stream_channel.hpp"

#include <CppUTest/TestHarness.h>

#include <map>

namespace biteline {

TEST_GROUP(GigeStream) {
  std::vector<std::vector<std::uint8_t>> sent;
  gige::StreamChannel channel{
      [this](std::span<const std::uint8_t> packet) { sent.emplace_back(packet.begin(), packet.end()); }};

  void send_frame(std::size_t bytes) {
    channel.begin({.width = 1, .height = 1});
    for (std::size_t i = 0; i < bytes; ++i) {
      const auto byte = static_cast<std::uint8_t>(i);
      channel.append({&byte, 1});
    }
    channel.finish(0);
  }
};

TEST(GigeStream, PacketsLeaveAsTheyFill) {
  channel.restart(36 + 10);
  channel.begin({.width = 1, .height = 1});
  LONGS_EQUAL(1, sent.size());
  channel.append(std::vector<std::uint8_t>(9));
  LONGS_EQUAL(1, sent.size());
  channel.append(std::vector<std::uint8_t>(12));
  LONGS_EQUAL(3, sent.size());
  channel.finish(0);
  LONGS_EQUAL(5, sent.size());
  LONGS_EQUAL(8 + 1, sent[3].size());
  LONGS_EQUAL(4, gige::word_at(sent[4], 4) & 0xff'ffff);
  LONGS_EQUAL(2, sent[4][4]);
}

TEST(GigeStream, WhatIsAskedForAgainIsTheSame) {
  channel.restart(36 + 10);
  send_frame(37);
  send_frame(20);  // no packet of the payload is empty
  LONGS_EQUAL(6 + 4, sent.size());
  const auto first = sent;
  sent.clear();
  channel.send_again({.channel = 0, .block = 1, .first = 0, .last = 0xff'ffff});
  channel.send_again({.channel = 0, .block = 2, .first = 0, .last = 3});
  CHECK(first == sent);
  LONGS_EQUAL(10, channel.counts().resent);
  sent.clear();
  channel.send_again({.channel = 0, .block = 2, .first = 3, .last = 2});
  CHECK(sent.empty());
}

TEST(GigeStream, WhatIsGoneIsSaid) {
  channel.restart(1400);
  send_frame(10);
  sent.clear();
  channel.send_again({.channel = 0, .block = 2, .first = 0, .last = 4});  // to come
  CHECK(sent.empty());
  channel.send_again({.channel = 0, .block = 0, .first = 4, .last = 4});
  LONGS_EQUAL(1, sent.size());
  LONGS_EQUAL(0x800c, gige::half_at(sent[0], 0));
  LONGS_EQUAL(1, channel.counts().unavailable);
}

TEST(GigeStream, NumbersOfFramesLeaveOutZeroAndOldFramesGo) {
  channel.restart(9000);
  std::map<int, int> numbers;
  for (int i = 0; i < 65'540; ++i) {
    sent.clear();
    send_frame(1);
    ++numbers[gige::half_at(sent[0], 2)];
  }
  LONGS_EQUAL(0, numbers.count(0));
  LONGS_EQUAL(65'535, numbers.size());
  // 32 MiB are kept, and no more.
  for (int i = 0; i < 5; ++i) {
    channel.begin({.width = 1, .height = 1});
    channel.append(std::vector<std::uint8_t>(10U << 20U));
    channel.finish(0);
  }
  sent.clear();
  channel.send_again({.channel = 0, .block = 5, .first = 0, .last = 0});  // of 6 to 10
  LONGS_EQUAL(0x800c, gige::half_at(sent[0], 0));
  channel.send_again({.channel = 0, .block = 10, .first = 0, .last = 0});
  LONGS_EQUAL(0, gige::half_at(sent[1], 0));
}

}  // namespace biteline
