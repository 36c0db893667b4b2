// SPDX-License-Identifier: MIT
#pragma once
/// \file Where a line's control comes in: addresses and listening sockets.

#include <sys/socket.h>
#include <unistd.h>

#include <cstdint>
#include <string>
#include <utility>

#include "common/core/result.hpp"
#include "host/apps/biteline-web/line/line_doors.hpp"

namespace biteline::web {

/// Owns a descriptor.
class Socket {
 public:
  Socket() = default;
  explicit Socket(int fd) : fd_{fd} {}
  Socket(Socket&& other) noexcept : fd_{std::exchange(other.fd_, -1)} {}
  Socket& operator=(Socket&& other) noexcept {
    std::swap(fd_, other.fd_);
    return *this;
  }
  ~Socket() {
    if (fd_ >= 0) ::close(fd_);
  }
  [[nodiscard]] int get() const { return fd_; }

 private:
  int fd_{-1};
};

struct Listening {
  Socket socket;
  std::uint16_t port{0};  ///< where it listens; the one that was asked for unless that was 0
};

/// Errc::InvalidArgument: no number of an interface; Errc::AuthenticationFailed: `at` is beyond loopback and
/// no peer is listed, or it is every interface; Errc::PeerRefused: taken.  `option`: for messages.
[[nodiscard]] Result<Listening> listen_for_line(const LineListener& at, bool peers_are_listed,
                                                const char* option);

/// The address alone, as a text that compares; empty: none.
[[nodiscard]] std::string text_of(const sockaddr_storage& storage);
/// The same of what was typed; empty: no number of an interface.
[[nodiscard]] std::string text_of_address(const std::string& typed);

}  // namespace biteline::web
