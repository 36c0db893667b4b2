// SPDX-License-Identifier: MIT
#include "hal/sim/gvcamera/control_channel.hpp"

#include <algorithm>

namespace biteline::sim {
namespace {

constexpr std::uint8_t k_command_key = 0x42;
constexpr std::uint16_t k_read_register = 0x80, k_write_register = 0x82, k_write_memory = 0x86;
constexpr std::uint32_t k_privilege = 0xa00;
constexpr std::size_t k_header_bytes = 8;
/// The server behind looks at its own clock a moment later than this does.
constexpr std::chrono::milliseconds k_server_is_later{20};

std::uint16_t half_at(std::span<const std::uint8_t> packet, std::size_t at) {
  return static_cast<std::uint16_t>(packet[at] << 8U | packet[at + 1]);
}

std::uint32_t word_at(std::span<const std::uint8_t> packet, std::size_t at) {
  return static_cast<std::uint32_t>(half_at(packet, at)) << 16U | half_at(packet, at + 2);
}

/// A command's answer has its number, and the command's own word plus one.
std::vector<std::uint8_t> reply(GvStatus status, std::span<const std::uint8_t> command,
                                std::span<const std::uint8_t> data) {
  const auto code = static_cast<std::uint16_t>(status);
  std::vector<std::uint8_t> packet(k_header_bytes + data.size());
  packet[0] = static_cast<std::uint8_t>(code >> 8U);
  packet[1] = static_cast<std::uint8_t>(code & 0xffU);
  packet[2] = command[2];
  packet[3] = static_cast<std::uint8_t>(command[3] + 1);
  packet[5] = static_cast<std::uint8_t>(data.size());
  packet[6] = command[6];
  packet[7] = command[7];
  std::ranges::copy(data, packet.begin() + k_header_bytes);
  return packet;
}

}  // namespace

std::optional<std::vector<std::uint8_t>> ControlChannel::answer_for(const GvPeer& from,
                                                                    std::span<const std::uint8_t> command,
                                                                    Clock::time_point now) {
  if (controller_ && now - heard_ > timeout_ + k_server_is_later) controller_.reset();
  asking_ = from;
  asked_at_ = now;
  if (command.size() < k_header_bytes + 4 || command[0] != k_command_key) return std::nullopt;
  const std::uint16_t kind = half_at(command, 2);
  const bool to_privilege = word_at(command, k_header_bytes) == k_privilege;
  const bool controls = controller_ == from;
  if (kind == k_read_register && to_privilege) {
    if (controls) heard_ = now;
    if (controls || !controller_) return std::nullopt;
    const std::uint8_t privilege[] = {0, 0, 0, static_cast<std::uint8_t>(privilege_)};
    return reply(GvStatus::Success, command, privilege);
  }
  if (kind != k_write_register && kind != k_write_memory) return std::nullopt;
  const bool takes_control = !controller_ && kind == k_write_register && to_privilege;
  if (controls || takes_control) return std::nullopt;
  return reply(GvStatus::AccessDenied, command, {});
}

void ControlChannel::set_privilege(std::uint32_t privilege) {
  privilege_ = privilege;
  if (privilege == 0) return controller_.reset();
  controller_ = asking_;
  heard_ = asked_at_;
}

}  // namespace biteline::sim
