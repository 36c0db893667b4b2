// SPDX-License-Identifier: MIT
#pragma once
/// \file Who may write to the simulated camera: one application at a time, as long as its heartbeat comes.

#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace biteline::sim {

/// Status codes of GigE Vision 1.2, table 18-2.
enum class GvStatus : std::uint16_t {
  Success = 0,
  InvalidParameter = 0x8002,
  InvalidAddress = 0x8003,
  WriteProtected = 0x8004,
  BadAlignment = 0x8005,
  AccessDenied = 0x8006,
};

/// Where a packet came from; both as on the wire.
struct GvPeer {
  std::uint32_t address{0};
  std::uint16_t port{0};
  bool operator==(const GvPeer&) const = default;
};

/// GigE Vision 1.2, chapter 10: who writes a value to the control channel's privilege (CCP) holds it until he
/// writes 0, or has not read it for as long as the heartbeat's timeout.  All others are denied.
///
/// Aravis 0.8.26's fake camera says nothing to a second application, takes writes of one without control, and
/// lets anybody's reading of the privilege count as the heartbeat.  Thread: one owner.
class ControlChannel {
 public:
  using Clock = std::chrono::steady_clock;

  /// The answer to a command that the camera shall not see; nothing: it may have it.
  [[nodiscard]] std::optional<std::vector<std::uint8_t>> answer_for(const GvPeer& from,
                                                                    std::span<const std::uint8_t> command,
                                                                    Clock::time_point now);
  /// The camera has this privilege now: from the last peer that was let through.
  void set_privilege(std::uint32_t privilege);
  void set_heartbeat_timeout(std::chrono::milliseconds timeout) { timeout_ = timeout; }

 private:
  std::optional<GvPeer> controller_;
  GvPeer asking_;
  Clock::time_point asked_at_{}, heard_{};
  std::uint32_t privilege_{0};
  std::chrono::milliseconds timeout_{3000};  ///< at power-up
};

}  // namespace biteline::sim
