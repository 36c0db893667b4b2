// SPDX-License-Identifier: MIT
#pragma once
/// \file One service at a time sends paths to an arm.

#include "common/core/result.hpp"
#include "host/report/file_lock.hpp"

namespace biteline::service {

/// Holds the arm at `host` (name or address) for this machine, for as long as the lock lives;
/// Errc::PeerRefused names who has it.  On loopback, where several simulated arms may be, the script's port
/// tells them apart, and so does the network namespace.
[[nodiscard]] Result<report::FileLock> hold_arm(const std::string& host, std::uint16_t script_port,
                                                const std::string& holder);

}  // namespace biteline::service
