// SPDX-License-Identifier: MIT
#pragma once
/// \file Datagrams to one port of this machine, from a port of their own: never blocking.

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "common/core/result.hpp"
#include "hal/linux/posix/descriptor.hpp"

namespace biteline::sim {

/// Thread: one owner.
class UdpSender {
 public:
  /// To 127.0.0.1.
  [[nodiscard]] static Result<UdpSender> open(std::uint16_t port);

  /// Nobody there is no fault: a controller does not know.
  void send(std::span<const std::uint8_t> bytes) const;
  /// What came back, if anything did.
  [[nodiscard]] std::optional<std::string> receive() const;

 private:
  UdpSender(hal::Descriptor socket, std::uint16_t port) : socket_{std::move(socket)}, port_{port} {}

  hal::Descriptor socket_;
  std::uint16_t port_;
};

}  // namespace biteline::sim
