// SPDX-License-Identifier: MIT
#pragma once
/// \file The version of its software, as a controller tells it to who connects.

#include <array>
#include <optional>
#include <span>

#include "host/robot/link/ur/tcp_stream.hpp"

namespace biteline::robot::ur {

/// Major, minor, bug fix: {10, 12, 1}.
using SoftwareVersion = std::array<int, 3>;

/// As Universal Robots' "Client interfaces" has it: the robot message (type 20) "version" (type 3) of the
/// primary and the secondary interface.  Nothing: it is not among what has arrived so far from the begin of a
/// connection on.  Errc::BadFormat: these bytes are none of that interface.
[[nodiscard]] Result<std::optional<SoftwareVersion>> version_in(std::span<const std::uint8_t> heard);

/// By a connection of its own to the script's port; nothing is sent.
[[nodiscard]] Result<SoftwareVersion> ask_version(const Endpoint& script, Nanoseconds patience);

}  // namespace biteline::robot::ur
