// SPDX-License-Identifier: MIT
#pragma once
/// \file Room in the kernel for what a camera sends before its receiver runs.

#include <cstdint>

#include "common/core/result.hpp"

namespace biteline::hal {

/// Gives the UDP socket that this process has bound to `port` room for `bytes`: as much as net.core.rmem_max
/// lets an ordinary program have, all of it with CAP_NET_ADMIN.  For sockets of libraries that keep them to
/// themselves.
/// \return the room that the kernel says the socket has now, bytes.  Errc::DeviceError: no such socket.
/// Thread: any; system calls, for start-up only.
[[nodiscard]] Result<int> enlarge_receive_buffer(std::uint16_t port, int bytes);

}  // namespace biteline::hal
