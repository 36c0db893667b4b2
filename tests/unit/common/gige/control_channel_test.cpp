// SPDX-License-Identifier: MIT
#include "common/gige/control_channel.hpp"

#include <CppUTest/TestHarness.h>

#include "common/gige/bootstrap.hpp"

namespace biteline {

using namespace std::chrono_literals;

TEST_GROUP(GigeControl) {
  gige::ControlChannel channel;
  gige::ControlChannel::Clock::time_point now{1h};
  const gige::Peer first{.address = 1, .port = 10}, second{.address = 1, .port = 11};

  static std::vector<std::uint8_t> command(std::uint8_t code, std::uint32_t address) {
    std::vector<std::uint8_t> packet(16);
    packet[0] = 0x42;
    packet[1] = 1;
    packet[3] = code;
    packet[5] = 8;
    gige::put_word(packet, 8, address);
    return packet;
  }
  bool may_write(const gige::Peer& peer, std::uint32_t address = 0xd00) {
    return !channel.answer_for(peer, command(0x82, address), now).has_value();
  }
};

TEST(GigeControl, NobodyWritesBeforeSomebodyControls) {
  CHECK_FALSE(may_write(first));
  CHECK(may_write(first, gige::bootstrap::k_privilege));
  channel.set_privilege(2);
  CHECK(may_write(first));
  CHECK_FALSE(may_write(second));
  CHECK_FALSE(may_write(second, gige::bootstrap::k_privilege));
  CHECK(channel.controller(now) == first);
}

TEST(GigeControl, AMissedHeartbeatGivesItBack) {
  channel.set_heartbeat_timeout(500ms);
  CHECK(may_write(first, gige::bootstrap::k_privilege));
  channel.set_privilege(2);
  now += 400ms;
  CHECK_FALSE(channel.answer_for(first, command(0x80, gige::bootstrap::k_privilege), now).has_value());
  now += 400ms;
  CHECK(channel.controller(now) == first);
  now += 400ms;
  CHECK_FALSE(channel.controller(now).has_value());
  CHECK(may_write(second, gige::bootstrap::k_privilege));
}

TEST(GigeControl, OthersReadWhoControls) {
  CHECK(may_write(first, gige::bootstrap::k_privilege));
  channel.set_privilege(2);
  const auto told = channel.answer_for(second, command(0x80, gige::bootstrap::k_privilege), now);
  CHECK(told.has_value());
  LONGS_EQUAL(2, gige::word_at(*told, 8));
}

}  // namespace biteline
