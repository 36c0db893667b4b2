// SPDX-License-Identifier: MIT
#pragma once
/// \file One service at a time sends paths to an arm.

#include "common/core/result.hpp"
#include "host/apps/biteline-host/controller.hpp"
#include "host/apps/biteline-host/options.hpp"
#include "host/report/file_lock.hpp"
#include "host/robot/link/ur/arm_claim.hpp"

namespace biteline::service {

/// Holds the arm at `host` (name or address) for this machine, for as long as the lock lives;
/// Errc::PeerRefused names who has it; Errc::WriteFailed: there is no place that all of the machine share. On
/// loopback, where several simulated arms may be, the script's port tells them apart, and so does the network
/// namespace.
[[nodiscard]] Result<report::FileLock> hold_arm(const std::string& host, std::uint16_t script_port,
                                                const std::string& holder);

/// The same against services on other machines: the controller's word (ArmClaim), told once it is had.
/// Nothing: it is not wanted (--hold-register -1).
[[nodiscard]] Result<std::unique_ptr<robot::ur::ArmClaim>> claim_arm(const RobotOptions& robot);

/// The same with an arm of another make: its program takes one host at a time, and this is that host for as
/// long as the link lives.  Errc::PeerRefused: another one is.  One that is away is called on and on.
[[nodiscard]] Result<std::shared_ptr<robot::other::ArmLink>> connect_arm(const HostPort& at);

}  // namespace biteline::service
