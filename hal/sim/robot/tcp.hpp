// SPDX-License-Identifier: MIT
#pragma once
/// \file The little of TCP that a controller on loopback needs: never blocking.

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "common/core/result.hpp"
#include "hal/linux/posix/descriptor.hpp"

namespace biteline::sim {

struct TcpListener {
  hal::Descriptor socket;
  std::uint16_t port{0};
};

/// On 127.0.0.1; port 0: a free one.
[[nodiscard]] Result<TcpListener> listen_on_loopback(std::uint16_t port);

/// A client waiting, if there is one.
[[nodiscard]] hal::Descriptor accept_from(const TcpListener& listener);

/// What has arrived, appended.  false: the peer is gone.
[[nodiscard]] bool read_available(const hal::Descriptor& socket, std::vector<std::uint8_t>& bytes);

/// Sends as much as goes at once and drops it from `bytes`.  false: the peer is gone.
[[nodiscard]] bool write_available(const hal::Descriptor& socket, std::vector<std::uint8_t>& bytes);

}  // namespace biteline::sim
