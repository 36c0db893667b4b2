// SPDX-License-Identifier: MIT
#pragma once
/// \file Where a sensor listens: "tcp://HOST:PORT", and whether that stays inside this machine.

#include <cstdint>
#include <string>

#include "common/core/result.hpp"

namespace biteline::wire {

struct Endpoint {
  std::string host;       ///< name or address, IPv6 in brackets; "*" and "0.0.0.0": every interface
  std::uint16_t port{0};  ///< 0: any free port (listeners only)

  /// Only what provably stays on the loopback interface; a name other than localhost does not.
  [[nodiscard]] bool loopback() const;
  [[nodiscard]] std::string text() const;
};

[[nodiscard]] Result<Endpoint> parse_endpoint(const std::string& text);

}  // namespace biteline::wire
