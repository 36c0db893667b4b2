// SPDX-License-Identifier: MIT
#include "common/gige/packets.hpp"

#include <CppUTest/TestHarness.h>

namespace biteline {

TEST_GROUP(GigePackets){};

TEST(GigePackets, CommandsAreWholeOrNone) {
  const std::vector<std::uint8_t> good{0x42, 0x11, 0, 0x80, 0, 4, 0x12, 0x34, 0, 0, 0x0a, 0};
  const auto command = gige::read_command(good);
  CHECK(command.has_value());
  LONGS_EQUAL(gige::command::k_read_register, command->code);
  LONGS_EQUAL(0x1234, command->id);
  CHECK(command->answer_wanted && command->extended_ids);
  LONGS_EQUAL(0xa00, gige::word_at(command->body, 0));
  for (std::size_t size = 0; size < good.size(); ++size)
    CHECK_FALSE(gige::read_command(std::span{good}.first(size)).has_value());
  std::vector<std::uint8_t> other = good;
  other[0] = 0x41;
  CHECK_FALSE(gige::read_command(other).has_value());
}

TEST(GigePackets, AnswersNameTheirCommand) {
  const gige::Command command{.code = gige::command::k_read_register, .id = 7, .body = {}};
  const std::uint8_t body[] = {1, 2, 3, 4};
  const std::vector<std::uint8_t> expected{0x80, 0x06, 0, 0x81, 0, 4, 0, 7, 1, 2, 3, 4};
  CHECK(expected == gige::answer(gige::Status::AccessDenied, command, body));
}

TEST(GigePackets, ResendsAreOfOrdinaryIdsOnly) {
  const std::vector<std::uint8_t> body{0, 1, 0, 2, 0xff, 0, 0, 3, 0, 0, 0, 4};
  gige::Command command{.code = gige::command::k_packet_resend, .body = body};
  const auto wish = gige::read_resend(command);
  CHECK(wish.has_value());
  LONGS_EQUAL(1, wish->channel);
  LONGS_EQUAL(2, wish->block);
  LONGS_EQUAL(3, wish->first);  // 24 bits
  LONGS_EQUAL(4, wish->last);
  command.extended_ids = true;
  CHECK_FALSE(gige::read_resend(command).has_value());
  command = {.code = gige::command::k_packet_resend, .body = std::span{body}.first(8)};
  CHECK_FALSE(gige::read_resend(command).has_value());
}

TEST(GigePackets, StreamHasTheBytesOfTheStandard) {
  const gige::FrameFacts frame{.block = 0x0102,
                               .chunks = true,
                               .stamp = 0x1122'3344'5566'7788,
                               .pixel_format = 0x0260'00c0,
                               .width = 5,
                               .height = 3};
  const std::vector<std::uint8_t> first{
      0, 0,    1, 2, 1, 0, 0, 0, 0, 0, 0x40, 1, 0x11, 0x22, 0x33, 0x44, 0x55, 0x66, 0x77, 0x88, 2, 0x60,
      0, 0xc0, 0, 0, 0, 5, 0, 0, 0, 3, 0,    0, 0,    0,    0,    0,    0,    0,    0,    0,    0, 0};
  CHECK(first == gige::leader(frame));
  const std::vector<std::uint8_t> last{0, 0, 1, 2, 2, 0, 0, 9,   0, 0, 0x40, 1,
                                       0, 0, 0, 3, 0, 0, 0, 200, 0, 0, 0,    0};
  CHECK(last == gige::trailer(frame, 9, 200));
  const std::uint8_t bytes[] = {7, 8};
  const std::vector<std::uint8_t> payload{0, 0, 1, 2, 3, 0, 0, 1, 7, 8};
  CHECK(payload == gige::payload_packet(0x0102, 1, bytes));
  const std::vector<std::uint8_t> gone{0x80, 0x0c, 1, 2, 3, 0, 0, 1};
  CHECK(gone == gige::unavailable_packet(0x0102, 1));
}

}  // namespace biteline
