// SPDX-License-Identifier: MIT
#pragma once
/// \file One TCP connection to a controller, every wait bounded.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "common/core/result.hpp"
#include "common/time/clocks.hpp"

namespace biteline::robot::ur {

struct Endpoint {
  std::string host;
  std::uint16_t port{0};
};

/// Move-only; closed when destroyed.  Not thread-safe.
class TcpStream {
 public:
  [[nodiscard]] static Result<TcpStream> connect(const Endpoint& endpoint, Nanoseconds patience);
  /// Does not wait for the peer's answer: write_now() takes nothing before, and fails when it is no.
  [[nodiscard]] static Result<TcpStream> begin(const Endpoint& endpoint);

  TcpStream() = default;
  TcpStream(TcpStream&& other) noexcept;
  TcpStream& operator=(TcpStream&& other) noexcept;
  ~TcpStream();

  [[nodiscard]] bool is_open() const { return socket_ >= 0; }
  void close();

  /// Everything, or an Error after `patience`.
  [[nodiscard]] Result<void> write_all(std::span<const std::uint8_t> bytes, Nanoseconds patience);
  [[nodiscard]] Result<void> write_all(std::string_view text, Nanoseconds patience);

  /// What goes at once, from the beginning of `text`; never waits.
  [[nodiscard]] Result<std::size_t> write_now(std::string_view text);

  /// Appends what has arrived, and never waits.  false: not open, or the peer has closed, and then it is
  /// closed here, too.  A write into a connection whose peer has closed succeeds once: only a look like this
  /// one tells.
  [[nodiscard]] bool take_now(std::vector<std::uint8_t>& bytes);
  /// The same, and drops it.
  [[nodiscard]] bool lives();

  /// Whom it is connected to, so that a later connection needs no look-up of names.
  [[nodiscard]] Endpoint numeric_peer() const;
  [[nodiscard]] int number() const { return socket_; }

  /// What has arrived within `patience`, in `bytes` (replaced); empty: nothing.  Errc::ConnectionLost at the
  /// end.
  [[nodiscard]] Result<void> read_some(std::vector<std::uint8_t>& bytes, Nanoseconds patience);

 private:
  int socket_{-1};
  std::string peer_;
};

/// Until one of them takes bytes or fails.
bool wait_for_room(std::span<const int> sockets, Nanoseconds patience);

}  // namespace biteline::robot::ur
