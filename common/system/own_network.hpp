// SPDX-License-Identifier: MIT
#pragma once
/// \file A network of its own for a simulated cell, so that several run beside each other on one machine.

#include "common/core/result.hpp"

namespace biteline {

/// From now on this process, and all that it starts, have a loopback of their own and no other interface.
/// What listens here is not seen outside, and a port that another program holds is free: GigE Vision fixes
/// the camera's.  Root may; another user where the kernel lets him make a user namespace, and stays himself.
/// Before the first thread: the kernel splits no process that has several.
/// Errors: NotSupported where this user may not, DeviceError when the loopback does not come up.
[[nodiscard]] Result<void> enter_own_network();

}  // namespace biteline
