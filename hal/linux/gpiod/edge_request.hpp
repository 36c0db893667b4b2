// SPDX-License-Identifier: MIT
#pragma once
/// \file A line's edges, asked from the kernel through its character device (interface version 2,
/// Linux 5.10).
///
/// Not through libgpiod: Debian 12 has 1.6, which speaks version 1 of the interface, and that numbers no
/// events, so a queue that ran over would lose edges in silence.  Version 2 counts them.

#include <cstdint>

#include "common/core/result.hpp"
#include "hal/api/gpio_line.hpp"
#include "hal/linux/posix/descriptor.hpp"

namespace biteline::hal {

/// Events that the kernel keeps for us at most; the largest that it takes for one line.
inline constexpr std::uint32_t k_gpio_event_queue = 1024;

/// Both ways, stamped on CLOCK_MONOTONIC.  The line is ours until the descriptor closes.
/// Errc::DeviceNotFound: no such chip or line; Errc::DeviceError with EBUSY: another process holds it.
[[nodiscard]] Result<Descriptor> request_edges(const GpioLineAddress& address);

/// The level of such a line; true: active.
[[nodiscard]] Result<bool> read_level(int request, const char* name) noexcept;

}  // namespace biteline::hal
