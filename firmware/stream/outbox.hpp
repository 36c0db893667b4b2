// SPDX-License-Identifier: MIT
#pragma once
/// \file Where packets leave; the socket, or a test.

#include <cstdint>
#include <span>
#include <string>

namespace biteline::stream {

/// Opaque address of a connected peer.
using PeerId = std::string;

class Outbox {
 public:
  Outbox() = default;
  Outbox(const Outbox&) = delete;
  Outbox& operator=(const Outbox&) = delete;
  virtual ~Outbox() = default;

  /// False: the peer's queue is full or the peer is gone; nothing was sent.  Never blocks.
  virtual bool send(const PeerId& peer, std::span<const std::uint8_t> packet) = 0;
};

}  // namespace biteline::stream
