// SPDX-License-Identifier: MIT
#pragma once
/// \file The packets of GigE Vision: commands and answers (GVCP), and the stream's (GVSP).  Without sockets.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace biteline::gige {

/// What a device answers a command with.
enum class Status : std::uint16_t {
  Success = 0,
  NotImplemented = 0x8001,
  InvalidParameter = 0x8002,
  InvalidAddress = 0x8003,
  WriteProtected = 0x8004,
  BadAlignment = 0x8005,
  AccessDenied = 0x8006,
  PacketUnavailable = 0x800c,  ///< of the stream: asked for again, and no longer kept
};

/// Codes of commands; an answer's code is one more.
namespace command {
inline constexpr std::uint16_t k_discovery = 0x02, k_packet_resend = 0x40;
inline constexpr std::uint16_t k_read_register = 0x80, k_write_register = 0x82;
inline constexpr std::uint16_t k_read_memory = 0x84, k_write_memory = 0x86;
}  // namespace command

inline constexpr std::size_t k_command_header_bytes = 8, k_stream_header_bytes = 8;
/// Of a packet of the stream before its own header.
inline constexpr std::size_t k_ip_udp_bytes = 28;
/// The most that one READMEM reads.
inline constexpr std::size_t k_most_memory_bytes = 536;

/// Pre: the bytes are there.
[[nodiscard]] std::uint16_t half_at(std::span<const std::uint8_t> packet, std::size_t at);
[[nodiscard]] std::uint32_t word_at(std::span<const std::uint8_t> packet, std::size_t at);
void put_half(std::span<std::uint8_t> packet, std::size_t at, std::uint16_t value);
void put_word(std::span<std::uint8_t> packet, std::size_t at, std::uint32_t value);

/// Where a packet came from; both as on the wire.
struct Peer {
  std::uint32_t address{0};
  std::uint16_t port{0};
  bool operator==(const Peer&) const = default;
};

/// A command as it came.
struct Command {
  std::uint16_t code{0};
  std::uint16_t id{0};
  bool answer_wanted{false};
  bool extended_ids{false};  ///< frames of 64 bits, which nobody was offered
  std::span<const std::uint8_t> body;
};

/// Nothing: no whole command.
[[nodiscard]] std::optional<Command> read_command(std::span<const std::uint8_t> packet);

/// An answer has its command's number, and the command's code plus one.
[[nodiscard]] std::vector<std::uint8_t> answer(Status status, const Command& command,
                                               std::span<const std::uint8_t> body);

/// Packets that a client lacks: of one frame, `first` to `last`.
struct ResendWish {
  std::uint16_t channel{0}, block{0};
  std::uint32_t first{0}, last{0};
};
[[nodiscard]] std::optional<ResendWish> read_resend(const Command& command);

/// What a frame's first and last packet tell.
struct FrameFacts {
  std::uint16_t block{1};  ///< the frame's number, 1 to 65535
  bool chunks{false};      ///< the picture is followed by chunks
  std::uint64_t stamp{0};  ///< ticks
  std::uint32_t pixel_format{0}, width{0}, height{0};
};

[[nodiscard]] std::vector<std::uint8_t> leader(const FrameFacts& frame);
/// `packet` counts the leader as 0; `chunk_bytes`: with their tags, the picture's own tag included.
[[nodiscard]] std::vector<std::uint8_t> trailer(const FrameFacts& frame, std::uint32_t packet,
                                                std::uint32_t chunk_bytes);
[[nodiscard]] std::vector<std::uint8_t> payload_packet(std::uint16_t block, std::uint32_t packet,
                                                       std::span<const std::uint8_t> bytes);
/// Says of a packet that it is gone for good.
[[nodiscard]] std::vector<std::uint8_t> unavailable_packet(std::uint16_t block, std::uint32_t packet);

}  // namespace biteline::gige
