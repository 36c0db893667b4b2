// SPDX-License-Identifier: MIT
#pragma once
/// \file What both ends of the simulated wires do with a local socket.

#include <sys/socket.h>
#include <sys/un.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <string>

#include "hal/sim/bus/message.hpp"

namespace biteline::sim {

/// One message off a stream: its size, 0 at the stream's end, -1 with errno.  Never waits for the first byte.
/// Messages are sent whole (the kernel does not split writes this small on a local socket), so the rest is
/// there when the begin is.
inline ssize_t receive_whole(int socket, BusMessage& message) {
  ssize_t size = 0;
  do {
    size = recv(socket, &message, sizeof message, MSG_DONTWAIT | MSG_PEEK);
    if (size <= 0) return size;
    if (size < static_cast<ssize_t>(sizeof message)) {
      errno = EAGAIN;
      return -1;
    }
    size = recv(socket, &message, sizeof message, MSG_DONTWAIT);
  } while (size < 0 && errno == EINTR);
  return size;
}

/// A name in the abstract namespace of local sockets, cut to what a socket address holds (107 characters).
class BusAddress {
 public:
  explicit BusAddress(const std::string& name) {
    address_.sun_family = AF_UNIX;
    length_ = std::min(name.size(), sizeof address_.sun_path - 1);
    std::memcpy(address_.sun_path + 1, name.data(), length_);  // a leading 0: abstract
  }
  [[nodiscard]] const sockaddr* get() const { return reinterpret_cast<const sockaddr*>(&address_); }
  [[nodiscard]] socklen_t size() const {
    return static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + length_);
  }

 private:
  sockaddr_un address_{};
  std::size_t length_{0};
};

}  // namespace biteline::sim
