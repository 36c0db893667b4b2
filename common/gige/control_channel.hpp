// SPDX-License-Identifier: MIT
#pragma once
/// \file Who may write to a GigE Vision device: one application at a time, as long as its heartbeat comes.

#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "common/gige/packets.hpp"

namespace biteline::gige {

/// GigE Vision 1.2, chapter 10: who writes a value to the control channel's privilege (CCP) holds it until he
/// writes 0, or has commanded nothing for as long as the heartbeat's timeout.  All others are denied.
/// Thread: one owner.
class ControlChannel {
 public:
  using Clock = std::chrono::steady_clock;

  /// The answer to a command that the device shall not see; nothing: it may have it.
  [[nodiscard]] std::optional<std::vector<std::uint8_t>> answer_for(const Peer& from,
                                                                    std::span<const std::uint8_t> command,
                                                                    Clock::time_point now);
  /// The device has this privilege now: from the last peer that was let through.
  void set_privilege(std::uint32_t privilege);
  void set_heartbeat_timeout(std::chrono::milliseconds timeout) { timeout_ = timeout; }
  /// Nothing: nobody controls the device, or its heartbeat is late by now.
  [[nodiscard]] std::optional<Peer> controller(Clock::time_point now) const;

 private:
  std::optional<Peer> controller_;
  Peer asking_;
  Clock::time_point asked_at_{}, heard_{};
  std::uint32_t privilege_{0};
  std::chrono::milliseconds timeout_{3000};  ///< at power-up
};

}  // namespace biteline::gige
