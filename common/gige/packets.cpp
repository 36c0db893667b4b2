// SPDX-License-Identifier: MIT
#include "common/gige/packets.hpp"

#include <algorithm>

namespace biteline::gige {
namespace {

constexpr std::uint8_t k_command_key = 0x42;
constexpr std::uint8_t k_answer_wanted = 0x01, k_extended_ids = 0x10;
constexpr std::uint8_t k_leader = 1, k_trailer = 2, k_payload = 3;
constexpr std::uint16_t k_image = 0x0001, k_with_chunks = 0x4000;
constexpr std::uint32_t k_packet_numbers = 0x00ff'ffff;

std::vector<std::uint8_t> stream_packet(std::uint16_t block, std::uint8_t format, std::uint32_t packet,
                                        std::size_t body_bytes) {
  std::vector<std::uint8_t> bytes(k_stream_header_bytes + body_bytes);
  put_half(bytes, 2, block);
  put_word(bytes, 4, static_cast<std::uint32_t>(format) << 24U | (packet & k_packet_numbers));
  return bytes;
}

std::uint16_t payload_type(const FrameFacts& frame) {
  return frame.chunks ? k_image | k_with_chunks : k_image;
}

}  // namespace

std::uint16_t half_at(std::span<const std::uint8_t> packet, std::size_t at) {
  return static_cast<std::uint16_t>(packet[at] << 8U | packet[at + 1]);
}

std::uint32_t word_at(std::span<const std::uint8_t> packet, std::size_t at) {
  return static_cast<std::uint32_t>(half_at(packet, at)) << 16U | half_at(packet, at + 2);
}

void put_half(std::span<std::uint8_t> packet, std::size_t at, std::uint16_t value) {
  packet[at] = static_cast<std::uint8_t>(value >> 8U);
  packet[at + 1] = static_cast<std::uint8_t>(value & 0xffU);
}

void put_word(std::span<std::uint8_t> packet, std::size_t at, std::uint32_t value) {
  put_half(packet, at, static_cast<std::uint16_t>(value >> 16U));
  put_half(packet, at + 2, static_cast<std::uint16_t>(value & 0xffffU));
}

std::optional<Command> read_command(std::span<const std::uint8_t> packet) {
  if (packet.size() < k_command_header_bytes || packet[0] != k_command_key) return std::nullopt;
  const std::size_t body_bytes = half_at(packet, 4);
  if (packet.size() < k_command_header_bytes + body_bytes) return std::nullopt;
  return Command{.code = half_at(packet, 2),
                 .id = half_at(packet, 6),
                 .answer_wanted = (packet[1] & k_answer_wanted) != 0,
                 .extended_ids = (packet[1] & k_extended_ids) != 0,
                 .body = packet.subspan(k_command_header_bytes, body_bytes)};
}

std::vector<std::uint8_t> answer(Status status, const Command& command, std::span<const std::uint8_t> body) {
  std::vector<std::uint8_t> packet(k_command_header_bytes + body.size());
  put_half(packet, 0, static_cast<std::uint16_t>(status));
  put_half(packet, 2, static_cast<std::uint16_t>(command.code + 1));
  put_half(packet, 4, static_cast<std::uint16_t>(body.size()));
  put_half(packet, 6, command.id);
  std::ranges::copy(body, packet.begin() + k_command_header_bytes);
  return packet;
}

std::optional<ResendWish> read_resend(const Command& command) {
  constexpr std::size_t k_bytes = 12;
  if (command.code != command::k_packet_resend || command.extended_ids || command.body.size() < k_bytes)
    return std::nullopt;
  return ResendWish{.channel = half_at(command.body, 0),
                    .block = half_at(command.body, 2),
                    .first = word_at(command.body, 4) & k_packet_numbers,
                    .last = word_at(command.body, 8) & k_packet_numbers};
}

std::vector<std::uint8_t> leader(const FrameFacts& frame) {
  constexpr std::size_t k_bytes = 36;
  std::vector<std::uint8_t> bytes = stream_packet(frame.block, k_leader, 0, k_bytes);
  const std::span<std::uint8_t> body = std::span{bytes}.subspan(k_stream_header_bytes);
  put_half(body, 2, payload_type(frame));
  put_word(body, 4, static_cast<std::uint32_t>(frame.stamp >> 32U));
  put_word(body, 8, static_cast<std::uint32_t>(frame.stamp & 0xffff'ffffU));
  put_word(body, 12, frame.pixel_format);
  put_word(body, 16, frame.width);
  put_word(body, 20, frame.height);
  return bytes;
}

std::vector<std::uint8_t> trailer(const FrameFacts& frame, std::uint32_t packet, std::uint32_t chunk_bytes) {
  const std::size_t body_bytes = frame.chunks ? 16 : 8;
  std::vector<std::uint8_t> bytes = stream_packet(frame.block, k_trailer, packet, body_bytes);
  const std::span<std::uint8_t> body = std::span{bytes}.subspan(k_stream_header_bytes);
  put_half(body, 2, payload_type(frame));
  put_word(body, 4, frame.height);
  if (frame.chunks) put_word(body, 8, chunk_bytes);
  return bytes;
}

std::vector<std::uint8_t> payload_packet(std::uint16_t block, std::uint32_t packet,
                                         std::span<const std::uint8_t> bytes) {
  std::vector<std::uint8_t> made = stream_packet(block, k_payload, packet, bytes.size());
  std::ranges::copy(bytes, made.begin() + k_stream_header_bytes);
  return made;
}

std::vector<std::uint8_t> unavailable_packet(std::uint16_t block, std::uint32_t packet) {
  std::vector<std::uint8_t> made = stream_packet(block, k_payload, packet, 0);
  put_half(made, 0, static_cast<std::uint16_t>(Status::PacketUnavailable));
  return made;
}

}  // namespace biteline::gige
