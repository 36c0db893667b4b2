// SPDX-License-Identifier: MIT
#pragma once
/// \file An arm's own kinematics, read from its controller.

#include <cstdint>
#include <optional>
#include <span>

#include "host/robot/kinematics/dh_rows.hpp"
#include "host/robot/link/ur/tcp_stream.hpp"

namespace biteline::robot::ur {

/// As Universal Robots' "Client interfaces" has it: robot state messages (type 16) of the primary and the
/// secondary interface, in them "kinematics info" (type 5), sent to who connects.
struct ToldKinematics {
  std::array<kinematics::DhRow, kinematics::k_joints> rows;
  std::uint32_t status{0};  ///< the controller's own word on its calibration
};

/// Of what has arrived so far from the begin of a connection on; nothing: it is not among it yet.
/// Errc::BadFormat: these bytes are none of that interface, or they hold no numbers.
[[nodiscard]] Result<std::optional<ToldKinematics>> kinematics_in(std::span<const std::uint8_t> heard);

/// By a connection of its own to the script's port or the primary one; nothing is sent.  Errc::Timeout: the
/// controller did not tell them within `patience`.
[[nodiscard]] Result<ToldKinematics> ask_kinematics(const Endpoint& script, Nanoseconds patience);

}  // namespace biteline::robot::ur
