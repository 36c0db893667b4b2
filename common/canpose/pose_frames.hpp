// SPDX-License-Identifier: MIT
#pragma once
/// \file The robot's pose in CAN frames: the layout of hal/linux/socketcan/POSE_FRAMES.md, coded and decoded.

#include <array>
#include <cstdint>
#include <span>

#include "common/core/result.hpp"
#include "common/geometry/se3.hpp"

namespace biteline::canpose {

inline constexpr std::uint32_t k_sync_id = 0x080;          ///< CiA 301, default COB-ID of SYNC
inline constexpr std::uint32_t k_default_base_id = 0x1A0;  ///< first of the ids a pose uses
inline constexpr std::uint32_t k_fd_id_offset = 8;         ///< base id + this: the CAN FD form
inline constexpr std::size_t k_classic_frames = 4;
inline constexpr std::size_t k_classic_size_bytes = 8;
inline constexpr std::size_t k_fd_size_bytes = 48;
inline constexpr std::uint8_t k_fd_layout_version = 1;
inline constexpr std::uint8_t k_sync_counter_last = 240;  ///< CiA 301: the counter runs 1..240

enum PoseBit : std::uint8_t {
  k_protective_stop = 1U << 0U,
  k_emergency_stop = 1U << 1U,
  k_program_running = 1U << 2U,
  k_simulated = 1U << 3U,
  k_pose_invalid = 1U << 7U,  ///< the arm does not know where it is; the pose's numbers mean nothing
};

/// One pose as its sender latched it.
struct PoseMessage {
  std::uint8_t sync_counter{0};  ///< of the SYNC that latched it, 1..240
  std::uint8_t status{0};        ///< PoseBit
  std::uint64_t stamp_us{0};     ///< the sender's clock at that SYNC; 32 bits of it in the classic form
  SE3 T_base_flange{SE3::Identity()};
};

using ClassicData = std::array<std::uint8_t, k_classic_size_bytes>;
using ClassicFrames = std::array<ClassicData, k_classic_frames>;
using FdFrame = std::array<std::uint8_t, k_fd_size_bytes>;

/// Errc::BadValue: a translation beyond 214 m.
[[nodiscard]] Result<ClassicFrames> encode_classic(const PoseMessage& pose);
[[nodiscard]] Result<FdFrame> encode_fd(const PoseMessage& pose);

/// Pre: the four data fields of one pose in the order of their ids.
/// Errc::ProtocolError: mixed counters, wrong check sum, or numbers that no sender makes.
[[nodiscard]] Result<PoseMessage> decode_classic(const ClassicFrames& frames);
[[nodiscard]] Result<PoseMessage> decode_fd(std::span<const std::uint8_t> data);

/// CRC-16/CCITT-FALSE: polynomial 0x1021, start 0xFFFF, no reflection, check("123456789") = 0x29B1.
[[nodiscard]] std::uint16_t crc16(std::span<const std::uint8_t> bytes) noexcept;

}  // namespace biteline::canpose
