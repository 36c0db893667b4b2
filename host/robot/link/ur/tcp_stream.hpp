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

  TcpStream() = default;
  TcpStream(TcpStream&& other) noexcept;
  TcpStream& operator=(TcpStream&& other) noexcept;
  ~TcpStream();

  [[nodiscard]] bool is_open() const { return socket_ >= 0; }
  void close();

  /// Everything, or an Error after `patience`.
  [[nodiscard]] Result<void> write_all(std::span<const std::uint8_t> bytes, Nanoseconds patience);
  [[nodiscard]] Result<void> write_all(std::string_view text, Nanoseconds patience);

  /// What has arrived within `patience`, in `bytes` (replaced); empty: nothing.  Errc::ConnectionLost at the
  /// end.
  [[nodiscard]] Result<void> read_some(std::vector<std::uint8_t>& bytes, Nanoseconds patience);

 private:
  int socket_{-1};
  std::string peer_;
};

}  // namespace biteline::robot::ur
