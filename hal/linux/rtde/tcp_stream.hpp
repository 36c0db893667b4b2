// SPDX-License-Identifier: MIT
#pragma once
/// \file A TCP connection to one peer that never blocks: connect, send and receive return at once.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "common/core/result.hpp"
#include "hal/linux/posix/descriptor.hpp"

namespace biteline::hal {

/// Until the socket has one of poll()'s `events` (a negative number: until the time is over).
void wait_for(int number, short events, Nanoseconds timeout);

/// Thread: one owner.
class TcpStream {
 public:
  struct Peer {
    std::string address;  ///< numeric; a name would need a resolver that blocks
    std::uint16_t port{0};
  };

  /// Begins to connect; connected() tells when it is done.
  [[nodiscard]] static Result<TcpStream> connect(const Peer& peer);

  /// true: done; false: not yet; an Error: refused or unreachable.
  [[nodiscard]] Result<bool> connected();

  /// Sends what the kernel takes and removes it from the front of `bytes`.
  [[nodiscard]] Result<void> send(std::vector<std::uint8_t>& bytes);

  /// What arrived, at most the whole of `buffer`; nothing when nothing did.  Errc::ConnectionLost at the
  /// peer's end.
  [[nodiscard]] Result<std::span<const std::uint8_t>> receive(std::span<std::uint8_t> buffer);

  [[nodiscard]] int number() const { return socket_.number(); }

 private:
  TcpStream(Descriptor socket, std::string name) : socket_{std::move(socket)}, name_{std::move(name)} {}

  Descriptor socket_;
  std::string name_;
  bool connected_{false};
};

}  // namespace biteline::hal
