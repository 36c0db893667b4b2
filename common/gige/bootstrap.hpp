// SPDX-License-Identifier: MIT
#pragma once
/// \file Addresses that GigE Vision fixes: the bootstrap registers of a device, and its port.

#include <cstddef>
#include <cstdint>

namespace biteline::gige {

inline constexpr std::uint16_t k_port = 3956;

/// Registers are 32 bits wide and big-endian; texts have the length behind them in bytes.
namespace bootstrap {
inline constexpr std::uint32_t k_version = 0x000, k_device_mode = 0x004;
inline constexpr std::uint32_t k_mac_high = 0x008, k_mac_low = 0x00c;
inline constexpr std::uint32_t k_ip_offered = 0x010, k_ip_used = 0x014;
inline constexpr std::uint32_t k_address = 0x024, k_mask = 0x034, k_gateway = 0x044;
inline constexpr std::uint32_t k_vendor = 0x048, k_model = 0x068, k_device_version = 0x088;
inline constexpr std::uint32_t k_manufacturer_info = 0x0a8, k_serial = 0x0d8, k_user_name = 0x0e8;
/// What DISCOVERY is answered with: everything below.
inline constexpr std::size_t k_discovery_bytes = 0x0f8;
inline constexpr std::uint32_t k_first_url = 0x200, k_second_url = 0x400;
inline constexpr std::uint32_t k_interfaces = 0x600, k_message_channels = 0x900, k_stream_channels = 0x904;
inline constexpr std::uint32_t k_capability = 0x934, k_heartbeat_timeout = 0x938;
inline constexpr std::uint32_t k_tick_frequency_high = 0x93c, k_tick_frequency_low = 0x940;
inline constexpr std::uint32_t k_privilege = 0xa00;
inline constexpr std::uint32_t k_stream_port = 0xd00, k_stream_packet_size = 0xd04, k_stream_delay = 0xd08;
inline constexpr std::uint32_t k_stream_address = 0xd18, k_stream_source_port = 0xd1c;
/// From here on registers are the maker's own.
inline constexpr std::uint32_t k_own = 0xa000;
}  // namespace bootstrap

/// Bits of k_capability.
inline constexpr std::uint32_t k_can_concatenate = 1U << 0U, k_can_write_memory = 1U << 1U,
                               k_can_resend = 1U << 2U, k_has_serial = 1U << 30U;

}  // namespace biteline::gige
